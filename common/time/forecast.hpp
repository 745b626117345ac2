/// What an incoming controller would command at a step, and whether the baton may go to it for that.
#pragma once

#include <array>
#include <string>

#include "base/types.hpp"

namespace baton {

using ReasonText = std::array<char, 200>;  // zero-terminated

/// Writes what would not fit up to its end.
void write(ReasonText& reason, const char* format, ...) noexcept __attribute__((format(printf, 2, 3)));

struct ArbiterMember {
  std::string name;
  bool requires_contact = false;  // not fit to take over out of contact
};

/// A controller's answer to being asked for a step.
struct Forecast {
  bool is_ready = false;
  JointVector effort;      // when it is ready [N m or N]
  ReasonText not_ready{};  // why not, else
};

/// The forecast's step as it was: what the holder commanded for it.
struct ForecastStep {
  JointVector holder_effort;
  bool in_contact = false;
};

struct Verdict {
  JointVector effort_step;  // forecast minus the holder's effort; empty when the two cannot be compared
  ReasonText objection{};   // empty: the handover may take place
  [[nodiscard]] bool isFeasible() const noexcept { return objection.front() == '\0'; }
};

/// @param max_effort_step  largest difference of any joint that is let through unless `force`.
[[nodiscard]] Verdict judge(const ArbiterMember& incoming, const Forecast& forecast, const ForecastStep& step,
                            double max_effort_step, bool force) noexcept;

}  // namespace baton
