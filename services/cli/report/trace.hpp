/// What happened in a recorded run, as numbers over time: the loop's messages decoded, a column a step.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "mcap/joined_reader.hpp"
#include "messages/loop.hpp"
#include "msg/swap.h"
#include "runtime/scenario.hpp"

namespace baton {

/// Stands for a number that was not recorded, or that there is none of.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Column k of every matrix is step first_step + k; what was not recorded is NaN.
struct Trace {
  Scenario scenario;    // as the file has it
  Eigen::MatrixXd q;    // joint positions, n x steps [rad or m]
  Eigen::MatrixXd qd;   // joint velocities, n x steps [rad/s or m/s]
  Eigen::MatrixXd tau;  // applied over the step before, after saturation, n x steps [N m or N]
  Eigen::MatrixXd q_d;  // desired, n x steps; all NaN when the motion is given in task space alone
  Eigen::MatrixXd qd_d;
  Eigen::MatrixXd qdd_d;
  Eigen::MatrixXd p_WE;              // tip position, 3 x steps [m]
  Eigen::MatrixXd p_WE_d;            // desired
  Eigen::MatrixXd orientation;       // rotation vector from the tip's orientation to the desired one, 3 x steps [rad]
  Eigen::MatrixXd zyz;               // tip orientation as ZYZ angles, as the report plots them, 3 x steps [rad]
  Eigen::MatrixXd zyz_d;             // desired
  Eigen::MatrixXd V_WE_d;            // desired, 6 x steps [m/s; rad/s]
  Eigen::MatrixXd A_WE_d;            // desired, 6 x steps [m/s^2; rad/s^2]
  Eigen::MatrixXd h_e;               // wrench the tip exerts on the environment, 6 x steps [N; N m]
  Eigen::MatrixXd h_d;               // desired wrench, 6 x steps
  std::uint64_t first_step = 0;      // 0 unless the run is a branch, or the recording begins later
  std::vector<std::uint64_t> chain;  // hash of all payloads of the loop up to the step before; 0: none
  std::vector<msg::SwapOutcome> swaps;  // those that took place, in order
  std::uint64_t missed_steps = 0;
  bool is_complete = false;  // by the recording's own certificate
  mcap::FileInfo info{};     // of the file

  [[nodiscard]] Eigen::Index steps() const { return q.cols(); }
  /// Of a column [s], to the bit what services make of its step's time_ns.
  [[nodiscard]] double time(Eigen::Index k) const {
    return static_cast<double>(stampOf(first_step + static_cast<std::uint64_t>(k), scenario.step_ns).time_ns) * 1e-9;
  }
  [[nodiscard]] Eigen::Index last() const { return steps() - 1; }
};

/// Throws UnavailableError when the file cannot be opened, UsageError when it is not the recording of a run: without a
/// scenario, a robot or states, or with states so far apart that most of the run is missing.
[[nodiscard]] Trace readTrace(const mcap::FileList& file);

}  // namespace baton
