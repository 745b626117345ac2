/// MuJoCo's dynamics of the same arm; see baton_dynamics.hpp. Each quantity calls the stages of MuJoCo's pipeline that
/// it needs and no others: mj_forward would also look for contacts and constraints, of which there are none.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <vector>

#include "bench/baton_dynamics.hpp"

namespace baton::bench {

class MujocoDynamics {
 public:
  /// Throws std::runtime_error with MuJoCo's reason when it refuses the model (a link that is no possible body).
  MujocoDynamics(const RobotModel& model, std::vector<DynamicState> states);

  VectorView inverseDynamics(int k) {
    setPosition(k);
    setVelocity(k);
    mju_copy(data_->qacc, states_[k].qdd.data(), model_->nv);
    mj_comVel(model_.get(), data_.get());
    mj_rne(model_.get(), data_.get(), 1, vector_.data());
    return view(vector_);
  }

  MatrixView massMatrix(int k) {
    setPosition(k);
    return massMatrixHere();
  }

  VectorView forwardDynamics(int k) {
    setPosition(k);
    setVelocity(k);
    mj_crb(model_.get(), data_.get());
    mj_factorM(model_.get(), data_.get());
    mj_comVel(model_.get(), data_.get());
    mj_rne(model_.get(), data_.get(), 0, vector_.data());
    mju_sub(g_.data(), states_[k].tau.data(), vector_.data(), model_->nv);
    mj_solveM(model_.get(), data_.get(), vector_.data(), g_.data(), 1);
    return view(vector_);
  }

  VectorView gravity(int k) {
    setPosition(k);
    return gravityHere();
  }

  Terms terms(int k) {
    setPosition(k);
    setVelocity(k);
    mj_comVel(model_.get(), data_.get());
    mj_rne(model_.get(), data_.get(), 0, vector_.data());
    return {massMatrixHere(), view(vector_), gravityHere()};
  }

 private:
  void setPosition(int k) {
    mju_copy(data_->qpos, states_[k].q.data(), model_->nq);
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
  }
  void setVelocity(int k) { mju_copy(data_->qvel, states_[k].qd.data(), model_->nv); }

  MatrixView massMatrixHere() {
    mj_crb(model_.get(), data_.get());
    mj_fullM(model_.get(), B_.data(), data_->qM);
    return {B_.data(), model_->nv, model_->nv};
  }

  VectorView gravityHere() {
    mju_zero(data_->qvel, model_->nv);
    mj_comVel(model_.get(), data_.get());
    mj_rne(model_.get(), data_.get(), 0, g_.data());
    return view(g_);
  }

  static VectorView view(const Eigen::VectorXd& v) { return {v.data(), v.size()}; }

  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };

  std::vector<DynamicState> states_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  Eigen::VectorXd vector_, g_;
  Eigen::MatrixXd B_;
};

}  // namespace baton::bench
