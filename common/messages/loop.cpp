#include "messages/loop.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <utility>

namespace baton {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

std::array<double, 3> toArray(const Eigen::Ref<const Vector3>& v) { return {v.x(), v.y(), v.z()}; }

std::array<double, 9> rowMajor(const Matrix3& m) {
  std::array<double, 9> rows{};
  Eigen::Map<RowMajor3>(rows.data()) = m;
  return rows;
}

constexpr const char* kNotFinite = "is not finite";

// Each returns what is wrong with a field, nullptr when nothing is.

template <class Values>
[[nodiscard]] const char* wrongWith(const Eigen::DenseBase<Values>& values) {
  static_assert(kLargestSignal == 1e12);
  if (isInRange(values)) return nullptr;
  return values.derived().allFinite() ? "is beyond 1e12" : kNotFinite;
}

template <class Segment>
[[nodiscard]] const char* read(const std::array<double, 3>& from, Segment&& to) {
  to = Eigen::Map<const Vector3>(from.data());
  return wrongWith(Eigen::Map<const Vector3>(from.data()));
}

[[nodiscard]] const char* read(const std::array<double, 9>& from, Matrix3& to) {
  to = Eigen::Map<const RowMajor3>(from.data());
  return wrongWith(to);
}

[[nodiscard]] const char* read(double from, double& to) {
  to = from;
  return wrongWith(Eigen::Matrix<double, 1, 1>(to));
}

/// One entry a joint.
struct Joints {
  const std::vector<double>& values;
  int n;
};

[[nodiscard]] const char* read(const Joints& from, JointVector& to) {
  const bool is_read = readSequence(from.values, from.n, to);
  if (from.values.size() != static_cast<std::size_t>(from.n)) return "has not one entry a joint";
  return is_read ? wrongWith(to) : kNotFinite;
}

void write(const Matrix3& R, msg::Quaternion& to) {
  const Eigen::Quaterniond quaternion(R);
  to.w(quaternion.w());
  to.x(quaternion.x());
  to.y(quaternion.y());
  to.z(quaternion.z());
}

[[nodiscard]] const char* read(const msg::Quaternion& from, Matrix3& R) {
  const Eigen::Quaterniond quaternion(from.w(), from.x(), from.y(), from.z());
  constexpr double kTolerance = 1e-6;  // far above rounding, far below a wrong rotation
  if (!quaternion.coeffs().allFinite()) return kNotFinite;
  if (!(std::abs(quaternion.norm() - 1.0) < kTolerance)) return "is no unit quaternion";
  R = quaternion.normalized().toRotationMatrix();
  return nullptr;
}

/// Reads field after field, until one is not as it should be.
class FieldReader {
 public:
  template <class From, class To>
  FieldReader& field(const char* name, const From& from, To&& to) {
    if (const char* wrong = reading_ ? read(from, std::forward<To>(to)) : nullptr) reading_ = {name, wrong};
    return *this;
  }
  [[nodiscard]] Reading reading() const { return reading_; }

 private:
  Reading reading_;
};

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

Reading fromMessage(const msg::PlantState& message, int n, RobotState& state) {
  return FieldReader()
      .field("position", Joints{message.position(), n}, state.q)
      .field("velocity", Joints{message.velocity(), n}, state.qd)
      .field("applied_effort", Joints{message.applied_effort(), n}, state.tau_applied)
      .field("tip_position", message.tip_position(), state.X_WE.p)
      .field("tip_orientation", message.tip_orientation(), state.X_WE.R)
      .field("tip_velocity", message.tip_velocity(), state.V_WE.head<3>())
      .field("tip_angular_velocity", message.tip_angular_velocity(), state.V_WE.tail<3>())
      .reading();
}

Reading fromMessage(const msg::Contact& message, Contact& contact) {
  return FieldReader()
      .field("penetration", message.penetration(), contact.penetration)
      .field("force", message.force(), contact.h_e.head<3>())
      .field("moment", message.moment(), contact.h_e.tail<3>())
      .field("force_by_position", message.force_by_position(), contact.df_dp)
      .field("force_by_velocity", message.force_by_velocity(), contact.df_dv)
      .reading();
}

Reading fromMessage(const msg::Reference& message, int n, Reference& reference) {
  const bool no_joints = message.position().empty() && message.velocity().empty() && message.acceleration().empty();
  const int joints = no_joints ? 0 : n;
  reference.has_task = message.has_task();
  return FieldReader()
      .field("position", Joints{message.position(), joints}, reference.q)
      .field("velocity", Joints{message.velocity(), joints}, reference.qd)
      .field("acceleration", Joints{message.acceleration(), joints}, reference.qdd)
      .field("tip_position", message.tip_position(), reference.X_WE.p)
      .field("tip_orientation", message.tip_orientation(), reference.X_WE.R)
      .field("tip_velocity", message.tip_velocity(), reference.V_WE.head<3>())
      .field("tip_angular_velocity", message.tip_angular_velocity(), reference.V_WE.tail<3>())
      .field("tip_acceleration", message.tip_acceleration(), reference.A_WE.head<3>())
      .field("tip_angular_acceleration", message.tip_angular_acceleration(), reference.A_WE.tail<3>())
      .field("force", message.force(), reference.h_d.head<3>())
      .field("moment", message.moment(), reference.h_d.tail<3>())
      .reading();
}

Reading fromMessage(const msg::JointCommand& message, int n, JointVector& effort) {
  return FieldReader().field("effort", Joints{message.effort(), n}, effort).reading();
}

}  // namespace baton
