#include "scenario.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>

namespace baton::bench {
namespace {

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

constexpr std::array<const char*, 6> kStandbys{"  - {name: joint, law: joint_inverse_dynamics}\n",
                                               "  - {name: force, law: force_pi}\n",
                                               "  - {name: pd, law: operational_pd}\n",
                                               "  - {name: admittance, law: admittance}\n",
                                               "  - {name: adaptive, law: adaptive}\n",
                                               "  - {name: parallel, law: parallel_force_position}\n"};

}  // namespace

std::string scenarioText(bool uses_force, int standbys, int steps, double rate) {
  const double step_s = static_cast<double>(kStep_ns) * 1e-9;
  std::string text = "name: bench\nrobot: rpp\n";
  text += "step_s: " + number(step_s) + "\n";
  text += "duration_s: " + number(step_s * steps) + "\n";
  text += "rate: " + (rate > 0.0 ? number(rate) : "max") + "\n";
  text +=
      "environment:\n"
      "  walls: [{point_m: [0, 0, 0.70], normal: [0, 0, 1], stiffness_N_per_m: 200}]\n"
      "trajectory:\n"
      "  waypoints:\n"
      "    - {time_s: 0, position: [0, 0, 0]}\n"
      "    - {time_s: 2, position: [pi/6, 0.2, 0.1]}\n"
      "  force_N: [0, 0, 3]\n"
      "controllers:\n";
  text +=
      uses_force ? "  - {name: active, law: impedance}\n" : "  - {name: active, law: operational_inverse_dynamics}\n";
  for (int i = 0; i < standbys; ++i) text += kStandbys.at(static_cast<std::size_t>(i));
  return text + "active: active\n";
}

}  // namespace baton::bench
