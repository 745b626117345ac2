/// What every library is given: the same arm at the same states.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "robot/model.hpp"
#include "support/robots.hpp"

namespace baton::bench {

/// q, qd, and either the acceleration that is wanted or the effort that acts.
struct DynamicState {
  JointVector q;    // rad or m
  JointVector qd;   // rad/s or m/s
  JointVector qdd;  // rad/s^2 or m/s^2
  JointVector tau;  // N m or N
};

[[nodiscard]] inline std::vector<DynamicState> randomStates(int joints, int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<DynamicState> states(count);
  for (DynamicState& state : states) {
    state.q = test::randomJointVector(generator, joints, 3.0);
    state.qd = test::randomJointVector(generator, joints, 2.0);
    state.qdd = test::randomJointVector(generator, joints, 5.0);
    state.tau = test::randomJointVector(generator, joints, 20.0);
  }
  return states;
}

/// Results stay in the library's own storage; these look at them without a copy.
using VectorView = Eigen::Map<const Eigen::VectorXd>;
using MatrixView = Eigen::Map<const Eigen::MatrixXd>;

}  // namespace baton::bench
