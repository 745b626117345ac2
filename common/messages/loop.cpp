#include "messages/loop.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace baton {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

std::array<double, 3> toArray(const Eigen::Ref<const Vector3>& v) { return {v.x(), v.y(), v.z()}; }

std::array<double, 9> rowMajor(const Matrix3& m) {
  std::array<double, 9> rows{};
  Eigen::Map<RowMajor3>(rows.data()) = m;
  return rows;
}

template <class Segment>
[[nodiscard]] bool read(const std::array<double, 3>& from, Segment&& to) {
  to = Eigen::Map<const Vector3>(from.data());
  return Eigen::Map<const Vector3>(from.data()).allFinite();
}

[[nodiscard]] bool read(const std::array<double, 9>& from, Matrix3& to) {
  to = Eigen::Map<const RowMajor3>(from.data());
  return to.allFinite();
}

void write(const Matrix3& R, msg::Quaternion& to) {
  const Eigen::Quaterniond quaternion(R);
  to.w(quaternion.w());
  to.x(quaternion.x());
  to.y(quaternion.y());
  to.z(quaternion.z());
}

[[nodiscard]] bool read(const msg::Quaternion& from, Matrix3& R) {
  const Eigen::Quaterniond quaternion(from.w(), from.x(), from.y(), from.z());
  constexpr double kTolerance = 1e-6;  // far above rounding, far below a wrong rotation
  if (!(std::abs(quaternion.norm() - 1.0) < kTolerance)) return false;
  R = quaternion.normalized().toRotationMatrix();
  return true;
}

}  // namespace

void assignSequence(const JointVector& from, std::vector<double>& to) {
  to.assign(from.data(), from.data() + from.size());
}

bool readSequence(const std::vector<double>& from, int n, JointVector& to) {
  if (from.size() != static_cast<std::size_t>(n)) return false;
  to = Eigen::Map<const Eigen::VectorXd>(from.data(), n);
  return to.allFinite();
}

void prepare(msg::PlantState& message) {
  message.position().reserve(kMaxJoints);
  message.velocity().reserve(kMaxJoints);
  message.applied_effort().reserve(kMaxJoints);
}

void prepare(msg::Reference& message) {
  message.position().reserve(kMaxJoints);
  message.velocity().reserve(kMaxJoints);
  message.acceleration().reserve(kMaxJoints);
}

void prepare(msg::JointCommand& message) { message.effort().reserve(kMaxJoints); }

void toMessage(const StepStamp& stamp, const RobotState& state, const std::string& holder, std::uint64_t chain_hash,
               msg::PlantState& message) {
  message.step(stamp.step);
  message.time_ns(stamp.time_ns);
  assignSequence(state.q, message.position());
  assignSequence(state.qd, message.velocity());
  assignSequence(state.tau_applied, message.applied_effort());
  message.tip_position(toArray(state.X_WE.p));
  write(state.X_WE.R, message.tip_orientation());
  message.tip_velocity(toArray(state.V_WE.head<3>()));
  message.tip_angular_velocity(toArray(state.V_WE.tail<3>()));
  message.holder(holder);
  message.chain_hash(chain_hash);
}

void toMessage(const StepStamp& stamp, const Contact& contact, msg::Contact& message) {
  message.step(stamp.step);
  message.time_ns(stamp.time_ns);
  message.force(toArray(contact.h_e.head<3>()));
  message.moment(toArray(contact.h_e.tail<3>()));
  message.force_by_position(rowMajor(contact.df_dp));
  message.force_by_velocity(rowMajor(contact.df_dv));
  message.penetration(contact.penetration);
}

void toMessage(const StepStamp& stamp, const Reference& reference, msg::Reference& message) {
  message.step(stamp.step);
  message.time_ns(stamp.time_ns);
  assignSequence(reference.q, message.position());
  assignSequence(reference.qd, message.velocity());
  assignSequence(reference.qdd, message.acceleration());
  message.has_task(reference.has_task);
  message.tip_position(toArray(reference.X_WE.p));
  write(reference.X_WE.R, message.tip_orientation());
  message.tip_velocity(toArray(reference.V_WE.head<3>()));
  message.tip_angular_velocity(toArray(reference.V_WE.tail<3>()));
  message.tip_acceleration(toArray(reference.A_WE.head<3>()));
  message.tip_angular_acceleration(toArray(reference.A_WE.tail<3>()));
  message.force(toArray(reference.h_d.head<3>()));
  message.moment(toArray(reference.h_d.tail<3>()));
}

void toMessage(const StepStamp& stamp, const std::string& controller, const JointVector& effort,
               std::uint64_t inputs_hash, msg::JointCommand& message) {
  message.step(stamp.step);
  message.time_ns(stamp.time_ns);
  message.controller(controller);
  assignSequence(effort, message.effort());
  message.inputs_hash(inputs_hash);
}

bool fromMessage(const msg::PlantState& message, int n, RobotState& state) {
  return readSequence(message.position(), n, state.q) && readSequence(message.velocity(), n, state.qd) &&
         readSequence(message.applied_effort(), n, state.tau_applied) && read(message.tip_position(), state.X_WE.p) &&
         read(message.tip_orientation(), state.X_WE.R) && read(message.tip_velocity(), state.V_WE.head<3>()) &&
         read(message.tip_angular_velocity(), state.V_WE.tail<3>());
}

bool fromMessage(const msg::Contact& message, Contact& contact) {
  contact.penetration = message.penetration();
  return std::isfinite(contact.penetration) && read(message.force(), contact.h_e.head<3>()) &&
         read(message.moment(), contact.h_e.tail<3>()) && read(message.force_by_position(), contact.df_dp) &&
         read(message.force_by_velocity(), contact.df_dv);
}

bool fromMessage(const msg::Reference& message, int n, Reference& reference) {
  const bool no_joints = message.position().empty() && message.velocity().empty() && message.acceleration().empty();
  if (no_joints) {
    reference.q.resize(0);
    reference.qd.resize(0);
    reference.qdd.resize(0);
  } else if (!readSequence(message.position(), n, reference.q) || !readSequence(message.velocity(), n, reference.qd) ||
             !readSequence(message.acceleration(), n, reference.qdd)) {
    return false;
  }
  reference.has_task = message.has_task();
  return read(message.tip_position(), reference.X_WE.p) && read(message.tip_orientation(), reference.X_WE.R) &&
         read(message.tip_velocity(), reference.V_WE.head<3>()) &&
         read(message.tip_angular_velocity(), reference.V_WE.tail<3>()) &&
         read(message.tip_acceleration(), reference.A_WE.head<3>()) &&
         read(message.tip_angular_acceleration(), reference.A_WE.tail<3>()) &&
         read(message.force(), reference.h_d.head<3>()) && read(message.moment(), reference.h_d.tail<3>());
}

bool fromMessage(const msg::JointCommand& message, int n, JointVector& effort) {
  return readSequence(message.effort(), n, effort);
}

}  // namespace baton
