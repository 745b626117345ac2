/// Admittance control: the measured force moves a compliant frame t, and a stiff motion loop follows it:
///   outer  Mt z'' + Kdt z' + Kpt z = h_e,   x_t = x_d - z,
///   inner  tau = B(q) y + n(q, qd) + J^T h_e,   y = J^-1 (xdd_t + Kd (xd_t - xd) + Kp (x_t - x) - Jdot qd).
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 9.3.
/// Assumes a model without friction and a configuration away from singularities. With the position solver and three
/// joints x_t - x obeys e'' + Kd e' + Kp e = 0, so that once it is on the frame the tip answers as Mt, Kdt and Kpt say,
/// however stiff the inner loop must be against disturbances. At rest Kpt z = h_e and x = x_d - z.
/// The frame gives way in position only: contact at the tip is at a point, which carries no moment. With a
/// six-dimensional solver the orientation follows x_d at the inner loop's stiffness.
/// The report prints h_e^d = Mt z'' + Kdt z' + Kpt z~ and names z~ = x_d - x_t the error: one quantity under two names,
/// here z. It gives no inner law; without J^T h_e in it, the wall would push the tip off x_t.
///
/// z is advanced exactly, h_e held over the step. It does not wind up against an effort limit: it is a stable filter of
/// a force that was measured.
/// Handover: one acceleration of the tip is to be matched by z and z'. The frame starts on the tip (x_t = x, xd_t = xd)
/// and is shifted by the least that matches, where a velocity counts as the distance it makes in 1 / sqrt(Kp). With
/// three joints, away from singularities, the effort then goes on where it was.
#include <Eigen/QR>
#include <array>
#include <cmath>

#include "control/law.hpp"
#include "control/mass_spring_damper.hpp"
#include "control/model_terms.hpp"
#include "control/task_space.hpp"
#include "robot/dynamics.hpp"

namespace baton::laws {
namespace {

using FrameState = std::array<MassSpringDamper::State, 3>;  // z and z', by axis

std::array<MassSpringDamper, 3> compliantFrame(const ParameterValues& values) {
  const auto mt = vector<Vector3>(values, "mt"), kdt = vector<Vector3>(values, "kdt"),
             kpt = vector<Vector3>(values, "kpt");
  const auto axis = [&](int i) { return MassSpringDamper(mt(i), kdt(i), kpt(i)); };
  return {axis(0), axis(1), axis(2)};
}

class Admittance final : public Law {
 public:
  Admittance(const RobotModel& model, const ParameterValues& values)
      : model_(believedModel(model, values)),
        solver_(taskSolver(values)),
        frame_(compliantFrame(values)),
        kp_(vector<Vector6>(values, "kp")),
        kd_(vector<Vector6>(values, "kd")) {}

  void reset() noexcept override { z_ = {}; }

  void handover(const LawInput& input) noexcept override {
    reset();
    if (check(input) != LawStatus::kOk) return;
    FrameState z;
    if (matchAppliedEffort(input, z)) z_ = z;
  }

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const LawStatus checked = check(input);
    if (checked != LawStatus::kOk) return checked;
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    const Vector6& h_e = input.contact.h_e;
    computeKinematics(model_, q, qd, kinematics_);
    JointVector y(model_.size());
    const LawStatus solved = solveTask(solver_, kinematics_, wantedAcceleration(input, z_), qd, y);
    if (solved != LawStatus::kOk) return solved;
    JointVector effort(model_.size());
    inverseDynamics(model_, q, qd, y, h_e, effort);
    if (!effort.allFinite()) return LawStatus::kNotFinite;

    for (int i = 0; i < 3; ++i) z_[i] = frame_[i].advanced(z_[i], h_e(i), input.dt_s);
    tau = effort;
    return LawStatus::kOk;
  }

  void archive(StateArchive& state) noexcept override {
    for (MassSpringDamper::State& axis : z_) state(axis.z, axis.zd);
  }

 private:
  static LawStatus check(const LawInput& input) noexcept {
    if (!input.reference.has_task) return LawStatus::kMissingReference;
    const bool is_finite = std::isfinite(input.dt_s) && input.state.q.allFinite() && input.state.qd.allFinite() &&
                           input.contact.h_e.allFinite() && isTaskFinite(input.reference);
    return is_finite ? LawStatus::kOk : LawStatus::kNotFinite;
  }

  /// The inner loop's wish for the tip, less Jdot qd. Reads kinematics_.
  Vector6 wantedAcceleration(const LawInput& input, const FrameState& z) const noexcept {
    const Reference& ref = input.reference;
    Vector6 x_error = poseError(ref.X_WE, kinematics_.X_WE);
    Vector6 xd_error = ref.V_WE - kinematics_.V_WE;
    Vector6 a = ref.A_WE - kinematics_.Jdot_qd;
    for (int i = 0; i < 3; ++i) {
      x_error(i) -= z[i].z;
      xd_error(i) -= z[i].zd;
      a(i) -= frame_[i].acceleration(z[i], input.contact.h_e(i));
    }
    return a + kd_.cwiseProduct(xd_error) + kp_.cwiseProduct(x_error);
  }

  /// z for which this step's effort is the one that was applied, as near as the arm allows; false where there is none.
  bool matchAppliedEffort(const LawInput& input, FrameState& z) noexcept {
    JointVector y_applied, y(model_.size());
    if (!appliedAcceleration(model_, input.state, input.contact.h_e, y_applied)) return false;
    computeKinematics(model_, input.state.q, input.state.qd, kinematics_);
    const Vector3 x_error = input.reference.X_WE.p - kinematics_.X_WE.p;
    const Vector3 xd_error = (input.reference.V_WE - kinematics_.V_WE).head<3>();
    for (int i = 0; i < 3; ++i) z[i] = {x_error(i), xd_error(i)};  // the frame on the tip

    // What must be added to the wanted acceleration, given what the arm makes of each axis of it.
    const JointVector at_rest = JointVector::Zero(model_.size());
    if (solveTask(solver_, kinematics_, wantedAcceleration(input, z), input.state.qd, y) != LawStatus::kOk)
      return false;
    const Vector3 missing = kinematics_.J.topRows<3>() * (y_applied - y);
    Matrix3 response;
    for (int i = 0; i < 3; ++i) {
      if (solveTask(solver_, kinematics_, Vector6::Unit(i), at_rest, y) != LawStatus::kOk) return false;
      response.col(i) = kinematics_.J.topRows<3>() * y;
    }
    const Vector3 added = response.completeOrthogonalDecomposition().solve(missing);

    // (Kpt / Mt - Kp) dz + (Kdt / Mt - Kd) dz' = added, with the least dz^2 + dz'^2 / Kp.
    bool is_finite = true;
    for (int i = 0; i < 3; ++i) {
      const double rate = std::sqrt(kp_(i));
      const double by_z = frame_[i].stiffness() / frame_[i].mass() - kp_(i);
      const double by_zd = rate * (frame_[i].damping() / frame_[i].mass() - kd_(i));
      const double share = added(i) / (by_z * by_z + by_zd * by_zd);
      z[i].z += by_z * share;
      z[i].zd += rate * by_zd * share;
      is_finite = is_finite && std::isfinite(z[i].z) && std::isfinite(z[i].zd);
    }
    return is_finite;
  }

  RobotModel model_;
  TaskSolver solver_;
  std::array<MassSpringDamper, 3> frame_;
  Vector6 kp_, kd_;  // inner
  Kinematics kinematics_;
  FrameState z_ = {};
};

}  // namespace

LawInfo admittance() {
  std::vector<ParameterSpec> parameters = {
      {.name = "mt",
       .unit = "kg",
       .doc = "mass of the compliant frame",
       .size = ParameterSize::kThree,
       .default_numbers = {1.0},
       .minimum = 1e-3,
       .choices = {}},
      {.name = "kdt",
       .unit = "N s/m",
       .doc = "damping of the compliant frame",
       .size = ParameterSize::kThree,
       .default_numbers = {30.0},
       .minimum = 0.0,
       .choices = {}},
      {.name = "kpt",
       .unit = "N/m",
       .doc = "stiffness of the compliant frame; 0 lets a hand lead it anywhere",
       .size = ParameterSize::kThree,
       .default_numbers = {200.0},
       .minimum = 0.0,
       .choices = {}},
      {.name = "kp",
       .unit = "1/s^2",
       .doc = "stiffness of the inner motion loop; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {2500.0},
       .minimum = 1e-3,
       .choices = {}},
      {.name = "kd",
       .unit = "1/s",
       .doc = "damping of the inner motion loop; the position solver reads the first three",
       .size = ParameterSize::kSix,
       .default_numbers = {100.0},
       .minimum = 0.0,
       .choices = {}},
      massScaleParameter(),
  };
  for (ParameterSpec& spec : taskSolverParameters()) parameters.push_back(std::move(spec));
  return {.name = "admittance",
          .summary = "admittance control: the contact force shifts the motion that a stiff inner loop follows",
          .uses_force = true,
          .parameters = std::move(parameters),
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<Admittance>(model, values);
          }};
}

}  // namespace baton::laws
