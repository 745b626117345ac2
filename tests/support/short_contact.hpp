/// A scenario of half a second that has everything: free motion, contact, two handovers, a force law, a standby.
#pragma once

#include <string>

#include "support/processes.hpp"

namespace baton::test {

inline constexpr int kShortSteps = 1000;
inline constexpr int kFirstSwap = 300;
inline constexpr int kSecondSwap = 700;

/// The file's text; `extra` is appended (more keys), `robot` may point elsewhere.
[[nodiscard]] inline std::string shortContact(const std::string& extra = "") {
  return "name: short\n"
         "robot: " +
         (deployFolder() / "robots/rpp.yaml").string() +
         "\n"
         "step_s: 0.0005\nsubsteps: 2\nduration_s: 0.5\n"
         "start: {position: [0.42, 0.15, 0.08]}\n"
         "environment:\n  walls: [{point_m: [0, 0, 0.66], normal: [0, 0, 1], stiffness_N_per_m: 200, "
         "damping_N_s_per_m: 1}]\n"
         "trajectory:\n  waypoints:\n"
         "    - {time_s: 0, position: [0.42, 0.15, 0.08]}\n"
         "    - {time_s: 0.2, position: [pi/6, 0.2, 0.1]}\n"
         "  force_N: [0, 0, 3]\n"
         "controllers:\n"
         "  - {name: tracking, law: operational_inverse_dynamics}\n"
         "  - {name: impedance, law: impedance}\n"
         "  - {name: force, law: force_pi}\n"
         "  - {name: pd, law: joint_pd}\n"
         "active: tracking\n"
         "swaps:\n  - {at_s: 0.15, to: impedance}\n  - {at_s: 0.35, to: force}\n" +
         extra;
}

/// The same without an end and without planned handovers, as fast as possible.
[[nodiscard]] inline std::string endlessContact(const std::string& extra = "") {
  std::string text = shortContact();
  const std::string duration = "duration_s: 0.5\n";
  text.erase(text.find(duration), duration.size());
  text.erase(text.find("swaps:"));  // the last key
  return text + extra;
}

/// The same at rest, where it touches nothing.
[[nodiscard]] inline std::string restingContact(const std::string& extra = "") {
  std::string text = endlessContact(extra);
  const std::string way = "    - {time_s: 0.2, position: [pi/6, 0.2, 0.1]}\n";
  return text.erase(text.find(way), way.size());
}

}  // namespace baton::test
