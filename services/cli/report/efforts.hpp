/// What every controller of a recorded run commanded, or would have: the efforts of who held the baton and of those
/// that stood by, beside what the joints felt.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "msg/swap.h"
#include "trace.hpp"

namespace baton {

/// Columns are steps, as in the trace; what was not recorded is NaN.
struct RecordedEfforts {
  static constexpr int kBrake = -1;
  static constexpr int kUnknown = -2;

  Trace trace;
  std::vector<Eigen::MatrixXd> effort;    // of each of the scenario's controllers, n x steps [N m or N]
  std::vector<int> holder;                // of each step: index of a controller, kBrake, or kUnknown
  std::vector<msg::SwapOutcome> refused;  // requests that came to nothing; dry runs are not among them
  std::vector<msg::SwapReport> reports;   // measured over the blends
  std::uint64_t lost_steps = 0;           // without their state, or without a command of who held the baton
  std::uint64_t doubled_steps = 0;        // with two states, or with commands of the holder that contradict each other
  std::string cut;                        // where and why the file was cut off; empty: it was not

  /// Over step k, n entries; NaN in the last column, whose step is still open.
  [[nodiscard]] Eigen::VectorXd applied(Eigen::Index k) const;
};

/// Throws as readTrace does.
[[nodiscard]] RecordedEfforts readEfforts(const mcap::FileList& file);
/// The same with the file's trace, which has been read already.
[[nodiscard]] RecordedEfforts readEfforts(const mcap::FileList& file, Trace trace);

/// The scenario's controller called so: its index, or kUnknown.
[[nodiscard]] int controllerIndex(const Scenario& scenario, std::string_view name);

}  // namespace baton
