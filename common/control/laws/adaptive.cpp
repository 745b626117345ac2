/// Adaptive control of Slotine and Li:
///   tau = Y(q, qd, qd_r, qdd_r) Th + Kd s,   qd_r = qd_d + lam e,   s = qd_r - qd,   Th' = K^-1 Y^T s,   e = q_d - q,
/// with Y Th = B qdd_r + C(q, qd) qd_r + Fv qd_r + g, Th the estimate of the links' standard dynamic parameters and of
/// the joints' viscous friction (robot/regressor.hpp).
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 8.5.4.
/// Assumes a rigid arm whose geometry and gravity are known, viscous friction and no contact. With Th~ the estimate's
/// error, V = (s^T B s + Th~^T K Th~) / 2 then falls at s^T (Kd + Fv) s, as dB/dt - 2C is skew-symmetric: e goes to
/// zero from any estimate. The estimate itself goes to the truth only as far as the motion asks for it.
///
/// The report derives it for one joint, I qdd + F qd + m g d sin(q) = tau, with Th = (I, F, m g d) and
/// Y = (qdd_r, qd_r, sin q). This law is that one at n = 1, by two choices that make sense for any chain:
/// - K acts on first moments times gravity, m g c, as on the report's m g d. Without that the report's K would mean
///   g^2 = 96 times as fast a learning of gravity.
/// - `unknowns: nonzero` takes what is zero in the robot file, such as the offset of a centre of mass from the axis of
///   its bar, as known to be zero. `all` estimates everything.
/// The report prints Y(qdd_r, qd_r, q) without the velocity that C needs in general, and gives no initial estimate;
/// zero, as a Simulink integrator starts, is the default. With its K = 30.2 the estimate hardly moves over 20 s: it is
/// lam Kd, a stiff PD, that tracks. `adaptation: times_k` is the other reading of its equation, Th' = K Y^T s.
///
/// The estimate is advanced step by step, and s is not felt in between. With Y held, one joint on its own is stable
/// only while dt Y K^-1 Y^T < Kd, and a start with a large error makes Y large. So Th' is divided by 1 + dt times the
/// sum over joints of (Y K^-1 Y^T)_ii / Kd_i, the normalised gradient of discrete adaptive control (Goodwin, Sin,
/// Adaptive Filtering, Prediction and Control (1984)). It tends to 1 as the step shrinks.
///
/// Handover keeps the estimate. A law that stands by does not learn either: it would learn from errors that it does not
/// cause. So what a step learns counts from the next step, unless a handover comes between.
/// Anti-windup: the estimate waits while its change would ask more of a joint whose limit cut the last effort
/// (control/anti_windup.hpp).
#include <cmath>

#include "control/anti_windup.hpp"
#include "control/law.hpp"
#include "robot/regressor.hpp"

namespace baton::laws {
namespace {

/// What multiplies Y^T s in Th', parameter by parameter; zero for what is not estimated.
DynamicParameters learningRates(const RobotModel& model, const ParameterValues& values) {
  const std::string adaptation = choice(values, "adaptation");
  const double k = number(values, "k");
  const double rate = adaptation == "on" ? 1.0 / k : adaptation == "times_k" ? k : 0.0;
  const DynamicParameters pi = dynamicParameters(model);
  DynamicParameters rates = DynamicParameters::Constant(pi.size(), rate);

  const double gravity_squared = model.gravity_W.squaredNorm();
  if (gravity_squared > 0.0) {
    for (int i = 0; i < model.size(); ++i) rates.segment<3>(i * kParametersPerJoint + 1) /= gravity_squared;
  }
  if (choice(values, "unknowns") == "nonzero") rates = (pi.array() != 0.0).select(rates, 0.0);
  return rates;
}

class Adaptive final : public Law {
 public:
  Adaptive(const RobotModel& model, const ParameterValues& values)
      : model_(model),
        lambda_(vector<JointVector>(values, "lambda")),
        kd_(vector<JointVector>(values, "kd")),
        rates_(learningRates(model, values)),
        initial_(number(values, "initial_scale") * dynamicParameters(model)),
        estimate_(initial_),
        learnt_(DynamicParameters::Zero(initial_.size())) {}

  void reset() noexcept override {
    estimate_ = initial_;
    learnt_.setZero();
    commanded_.resize(0);
  }

  void handover(const LawInput&) noexcept override {
    learnt_.setZero();
    commanded_.resize(0);
  }

  LawStatus step(const LawInput& input, JointVector& tau) noexcept override {
    const JointVector& q = input.state.q;
    const JointVector& qd = input.state.qd;
    const Reference& ref = input.reference;
    const int n = model_.size();
    if (ref.q.size() != n || ref.qd.size() != n || ref.qdd.size() != n) return LawStatus::kMissingReference;
    const JointVector qd_r = ref.qd + lambda_.cwiseProduct(ref.q - q);
    const JointVector qdd_r = ref.qdd + lambda_.cwiseProduct(ref.qd - qd);
    const JointVector s = qd_r - qd;

    // Every input but the step's length enters the effort, and NaN stays NaN, so this checks them all.
    const DynamicParameters estimate = estimate_ + learnt_;
    dynamicsRegressor(model_, q, qd, qd_r, qdd_r, Y_);
    JointVector effort = kd_.cwiseProduct(s);
    effort.noalias() += Y_ * estimate;
    const DynamicParameters increment = learning(input.dt_s, s);
    if (!effort.allFinite() || !increment.allFinite()) return LawStatus::kNotFinite;

    const JointVector cut = cutDirections(model_, commanded_, input.state.tau_applied);
    const bool waits = !cut.isZero(0.0) && pushesFurther(cut, Y_ * increment);
    estimate_ = estimate;
    learnt_ = increment;
    if (waits) learnt_.setZero();
    commanded_ = effort;
    tau = effort;
    return LawStatus::kOk;
  }

  void archive(StateArchive& state) noexcept override { state(estimate_, learnt_, commanded_); }

 private:
  /// What one step adds to the estimate; Y_ is this step's.
  DynamicParameters learning(double dt_s, const JointVector& s) const noexcept {
    double normaliser = 1.0;
    for (int i = 0; i < model_.size(); ++i) {
      normaliser += dt_s * Y_.row(i).cwiseAbs2().dot(rates_.transpose()) / kd_(i);
    }
    DynamicParameters increment = Y_.transpose() * s;
    increment.array() *= dt_s / normaliser * rates_.array();
    return increment;
  }

  RobotModel model_;
  JointVector lambda_, kd_;
  DynamicParameters rates_;
  DynamicParameters initial_;
  DynamicParameters estimate_;  // Th of the last step
  DynamicParameters learnt_;    // by that step, and not yet part of Th
  Regressor Y_;
  JointVector commanded_;  // effort of the step before; no entries when there was none
};

}  // namespace

LawInfo adaptive() {
  return {.name = "adaptive",
          .summary = "adaptive control (Slotine-Li): learns masses, inertias and friction while it tracks",
          .parameters =
              {
                  {.name = "lambda",
                   .unit = "1/s",
                   .doc = "rate at which the position error fades once s is zero",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {100.0},
                   .minimum = 0.0,
                   .choices = {}},
                  {.name = "kd",
                   .unit = "N m s/rad or N s/m",
                   .doc = "gain on s; over the inertia of a joint it is a pole that the step must respect",
                   .size = ParameterSize::kPerJoint,
                   .default_numbers = {500.0},
                   .minimum = 1e-3,
                   .choices = {}},
                  {.name = "k",
                   .unit = "",
                   .doc = "gain of the adaptation, SI units of each parameter: the larger, the slower it learns "
                          "(times_k: the faster)",
                   .size = ParameterSize::kScalar,
                   .default_numbers = {30.2},
                   .minimum = 1e-6,
                   .choices = {}},
                  {.name = "adaptation",
                   .unit = "",
                   .doc = "Th' = K^-1 Y^T s, none, or the report's other reading Th' = K Y^T s",
                   .size = ParameterSize::kChoice,
                   .default_numbers = {},
                   .choices = {"on", "off", "times_k"}},
                  {.name = "unknowns",
                   .unit = "",
                   .doc = "what is estimated: parameters that are not zero in the robot file, or all",
                   .size = ParameterSize::kChoice,
                   .default_numbers = {},
                   .choices = {"nonzero", "all"}},
                  {.name = "initial_scale",
                   .unit = "",
                   .doc = "the first estimate, as a multiple of the robot file's parameters",
                   .size = ParameterSize::kScalar,
                   .default_numbers = {0.0},
                   .minimum = 0.0,
                   .maximum = 1e3,
                   .choices = {}},
              },
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return std::make_unique<Adaptive>(model, values);
          }};
}

}  // namespace baton::laws
