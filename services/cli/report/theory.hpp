/// What theory says of a run, held against what its trace shows. Each check predicts from the scenario (law parameters,
/// robot, walls, trajectory) by an equation that stands beside it; what it takes from the product is the robot's
/// dynamics, which tests hold against other libraries, never a law. Where a check reads the desired motion from the
/// recording, followsScenario() vouches that it is the scenario's. Two compare the product with itself, and say that
/// distribution changed nothing rather than that it is right: followsScenario() and same_bytes_in_one_process.
///
/// Tolerances. Where things come to rest: 1e-4 of the predicted value, or 1e-6 where zero is predicted. While they
/// move: the equations are of continuous time, whereas a law acts once a step and its effort is held, so the arm obeys
/// what was right half a step ago on average. The difference is therefore allowed to be what moves in half a step,
/// step_s / 2 times the peak speed, unless a check says otherwise; it shrinks with the step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trace.hpp"

namespace baton {

struct Check {
  std::string what;  // the quantity, with the run's law or axis where several are checked
  std::string unit;
  double predicted = 0.0;
  double measured = 0.0;
  double tolerance = 0.0;    // in unit, or as a part of the predicted value
  bool is_relative = false;  // which of the two

  /// NaN on either side never passes.
  [[nodiscard]] bool passes() const;
};

/// What a figure asks for.
struct CheckRequest {
  std::string name;          // out of checkNames()
  int run = 0;               // index into the figure's runs
  std::optional<int> other;  // a second run to compare with, for checks that compare
};

[[nodiscard]] std::vector<std::string> checkNames();

/// Throws UsageError for a name that is not known, a run that is not there, a second run that is missing, or a run to
/// which the check does not apply.
[[nodiscard]] std::vector<Check> runCheck(const CheckRequest& request, const std::vector<Trace>& runs);

/// The recorded reference is what the scenario's trajectory says, to the bit, at every step: joints, pose of the tip,
/// its velocity and acceleration, wrench.
[[nodiscard]] Check followsScenario(const Trace& run);

/// x_F of a run under force control, rebuilt from the recorded forces: Kf (f_d - f_e) + Ki int (f_d - f_e), which
/// starts at the tip; 3 x steps [m]. It is nobody's message, and the report's Figures 50 and 51 plot it.
[[nodiscard]] Eigen::MatrixXd forceReference(const Trace& trace);

}  // namespace baton
