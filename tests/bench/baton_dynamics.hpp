/// Baton's dynamics in the shape that kdl_dynamics.hpp and mujoco_dynamics.hpp share: one object for one arm and a list
/// of states, one call for one quantity at the k-th state. A view is valid until the next call.
#pragma once

#include <utility>
#include <vector>

#include "bench/states.hpp"
#include "robot/dynamics.hpp"

namespace baton::bench {

/// B, C qd + g and g at one state.
struct Terms {
  MatrixView B;
  VectorView n;
  VectorView g;
};

class BatonDynamics {
 public:
  BatonDynamics(RobotModel model, std::vector<DynamicState> states)
      : model_(std::move(model)), states_(std::move(states)) {}

  VectorView inverseDynamics(int k) noexcept {
    const DynamicState& state = states_[k];
    baton::inverseDynamics(model_, state.q, state.qd, state.qdd, no_wrench_, vector_);
    return view(vector_);
  }

  MatrixView massMatrix(int k) noexcept {
    baton::massMatrix(model_, states_[k].q, B_);
    return view(B_);
  }

  VectorView forwardDynamics(int k) noexcept {
    const DynamicState& state = states_[k];
    if (!baton::forwardDynamics(model_, state.q, state.qd, state.tau, no_wrench_, vector_)) vector_.setZero();
    return view(vector_);
  }

  VectorView gravity(int k) noexcept {
    gravityEffort(model_, states_[k].q, g_);
    return view(g_);
  }

  Terms terms(int k) noexcept {
    const DynamicState& state = states_[k];
    baton::massMatrix(model_, state.q, B_);
    biasEffort(model_, state.q, state.qd, vector_);
    gravityEffort(model_, state.q, g_);
    return {view(B_), view(vector_), view(g_)};
  }

 private:
  static VectorView view(const JointVector& v) { return {v.data(), v.size()}; }
  static MatrixView view(const JointMatrix& M) { return {M.data(), M.rows(), M.cols()}; }

  RobotModel model_;
  std::vector<DynamicState> states_;
  const Vector6 no_wrench_ = Vector6::Zero();
  JointVector vector_, g_;
  JointMatrix B_;
};

}  // namespace baton::bench
