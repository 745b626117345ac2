/// Orocos KDL's dynamics of the same arm; see baton_dynamics.hpp. States are converted once, at construction.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <vector>

#include "bench/baton_dynamics.hpp"

namespace baton::bench {

class KdlDynamics {
 public:
  KdlDynamics(const RobotModel& model, const std::vector<DynamicState>& states);

  VectorView inverseDynamics(int k) {
    const State& state = states_[k];
    newton_euler_.CartToJnt(state.q, state.qd, state.qdd, no_wrenches_, vector_);
    return view(vector_);
  }

  MatrixView massMatrix(int k) {
    parameters_.JntToMass(states_[k].q, B_);
    return {B_.data.data(), B_.data.rows(), B_.data.cols()};
  }

  VectorView forwardDynamics(int k) {
    const State& state = states_[k];
    forward_.CartToJnt(state.q, state.qd, state.tau, no_wrenches_, vector_);
    return view(vector_);
  }

  VectorView gravity(int k) {
    parameters_.JntToGravity(states_[k].q, g_);
    return view(g_);
  }

  Terms terms(int k) {
    const State& state = states_[k];
    parameters_.JntToCoriolis(state.q, state.qd, vector_);
    parameters_.JntToGravity(state.q, g_);
    vector_.data += g_.data;
    return {massMatrix(k), view(vector_), view(g_)};
  }

 private:
  struct State {
    KDL::JntArray q, qd, qdd, tau;
  };
  static VectorView view(const KDL::JntArray& v) { return {v.data.data(), v.data.size()}; }

  KDL::Chain chain_;
  KDL::Wrenches no_wrenches_;
  KDL::ChainIdSolver_RNE newton_euler_;
  KDL::ChainFdSolver_RNE forward_;
  KDL::ChainDynParam parameters_;
  std::vector<State> states_;
  KDL::JntArray vector_, g_;
  KDL::JntSpaceInertiaMatrix B_;
};

}  // namespace baton::bench
