// A law is an equation of continuous time; what runs is sampled. It acts once a step and its effort is held, so that
// what acts on the arm is older than the state by half a step on average. As the step shrinks the sampled loop must
// therefore tend to the continuous law in first order: half the step, half the error. Nothing here names a law but
// where its default gains would not let it move: a law joins by being registered. What the limit of a law with state
// is, this test cannot say: each such law has an equation of its own to be held against, in its own test.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <complex>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;
using Numbers = std::vector<double>;

constexpr double kDuration = 0.2;       // s
constexpr double kStepTimesPole = 0.2;  // the largest step dt times the fastest pole lambda of the loop

/// An arm, a law and what it is to do. Everything is smooth: no limit is reached, and contact lasts if there is any.
struct Situation {
  std::string name;
  std::string law;
  ParameterValues parameters;
  RobotModel robot;
  JointVector start;  // at rest
  double Ke_N_per_m;  // of the report's wall; 0: none
  std::function<Reference(double time_s)> reference;

  [[nodiscard]] std::unique_ptr<Law> freshLaw() const {
    std::unique_ptr<Law> made = makeLaw(law, robot, parameters);
    made->reset();
    return made;
  }
  // NOLINTNEXTLINE(readability-identifier-naming): the name GoogleTest looks for
  friend void PrintTo(const Situation& situation, std::ostream* out) { *out << situation.name; }
};

/// q_d = centre + amplitude sin(2 t), and 3 N upwards for laws that control force.
std::function<Reference(double)> swaying(const RobotModel& robot, const JointVector& centre,
                                         const JointVector& amplitude) {
  return [=](double t) {
    constexpr double kRate = 2.0;  // 1/s
    const JointVector away = std::sin(kRate * t) * amplitude, qd = kRate * std::cos(kRate * t) * amplitude;
    Reference reference = referenceOf(robot, centre + away, qd, -kRate * kRate * away);
    reference.h_d.z() = 3.0;
    return reference;
  };
}

std::vector<Situation> situations() {
  const RobotModel arm = rppRobot(), link = link1Robot();
  const JointVector inside = Vector3(kPi / 6, 0.2, 0.1);  // the tip 25 mm inside the wall
  std::vector<Situation> all;
  for (const LawInfo& info : allLaws()) {
    ParameterValues parameters;
    if (info.name == "adaptive") {  // the default gains are for the link
      parameters = {{"lambda", Numbers{10.0}}, {"kd", Numbers{10.0, 10.0, 4.0}}, {"k", Numbers{0.1}}};
    }
    all.push_back({info.name + "_free", info.name, parameters, arm, Vector3(0.5, 0.18, 0.08), 0.0,
                   swaying(arm, inside, Vector3(0.2, 0.1, 0.05))});
    all.push_back({info.name + "_in_contact", info.name, parameters, arm, inside, 50.0,
                   swaying(arm, inside, Vector3(0.02, 0.02, 0.02))});
  }
  all.push_back({"adaptive_on_the_link",
                 "adaptive",
                 {},
                 link,
                 JointVector::Constant(1, 0.3),
                 0.0,
                 swaying(link, JointVector::Zero(1), JointVector::Constant(1, kPi / 3))});
  return all;
}

// --- the continuous law

JointVector effort(const Situation& s, Law& law, double time_s, const JointVector& q, const JointVector& qd) {
  LawInput input;
  input.dt_s = 1.0;  // a law without state has no use for it
  input.state = stateOf(s.robot, q, qd);
  input.contact = wallContact(s.Ke_N_per_m, input.state.X_WE.p);
  input.reference = s.reference(time_s);
  JointVector tau = JointVector::Constant(s.robot.size(), std::nan(""));
  EXPECT_EQ(law.step(input, tau), LawStatus::kOk);
  return tau;
}

JointVector accelerationUnder(const Situation& s, const JointVector& q, const JointVector& qd, const JointVector& tau) {
  JointVector qdd = JointVector::Constant(s.robot.size(), std::nan(""));
  EXPECT_TRUE(forwardDynamics(s.robot, q, qd, tau, wallContact(s.Ke_N_per_m, tipPose(s.robot, q).p).h_e, qdd));
  return qdd;
}

/// qdd when the effort answers what was late_s ago, to first order.
JointVector acceleration(const Situation& s, Law& law, double time_s, const JointVector& q, const JointVector& qd,
                         double late_s = 0.0) {
  JointVector prompt = accelerationUnder(s, q, qd, effort(s, law, time_s, q, qd));
  if (late_s == 0.0) return prompt;
  const JointVector tau = effort(s, law, time_s - late_s, q - late_s * qd, qd - late_s * prompt);
  return accelerationUnder(s, q, qd, tau);
}

/// The largest |pole| of the loop at its start, by differences.
double fastestPole(const Situation& s) {
  constexpr double kDifference = 1e-6;
  const Eigen::Index n = s.robot.size();
  Eigen::VectorXd x(2 * n);
  x << s.start, JointVector::Zero(n);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const Eigen::VectorXd d = kDifference * Eigen::VectorXd::Unit(2 * n, i), plus = x + d, minus = x - d;
    A.col(i).tail(n) = (acceleration(s, *s.freshLaw(), 0.0, plus.head(n), plus.tail(n)) -
                        acceleration(s, *s.freshLaw(), 0.0, minus.head(n), minus.tail(n))) /
                       (2.0 * kDifference);
  }
  return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues().cwiseAbs().maxCoeff();
}

// --- positions at `steps` equal times, n x steps

int stepsOf(const Situation& s) {
  return std::max(20, static_cast<int>(std::ceil(kDuration * fastestPole(s) / kStepTimesPole)));
}

/// The law acts `parts` times a step.
Eigen::MatrixXd sampled(const Situation& s, int steps, int parts) {
  ClosedLoop loop(s.robot, s.freshLaw(), kDuration / (steps * parts), s.start, s.reference);
  loop.Ke_N_per_m = s.Ke_N_per_m;
  Eigen::MatrixXd q(s.robot.size(), steps);
  for (int k = 0; k < steps; ++k) {
    for (int i = 0; i < parts; ++i) EXPECT_TRUE(loop.step());
    EXPECT_EQ(loop.force().z() > 0.0, s.Ke_N_per_m > 0.0) << "contact that ends is not smooth";
    q.col(k) = loop.q();
  }
  return q;
}

/// The law inside the derivative, by RK4, late by so much. Four stages a quarter of a step apart leave an error of the
/// order of (lambda dt / 4)^4, 1e-5.
Eigen::MatrixXd continuous(const Situation& s, int steps, double late_s = 0.0) {
  constexpr int kParts = 4;
  const double h = kDuration / (steps * kParts);
  const Eigen::Index n = s.robot.size();
  const auto law = s.freshLaw();
  const auto f = [&](double t, const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Eigen::VectorXd xd(2 * n);
    xd << x.tail(n), acceleration(s, *law, t, x.head(n), x.tail(n), late_s);
    return xd;
  };
  Eigen::VectorXd x(2 * n);
  x << s.start, JointVector::Zero(n);
  Eigen::MatrixXd q(n, steps);
  for (int k = 0; k < steps * kParts; ++k) {
    const double t = k * h;
    const Eigen::VectorXd k1 = f(t, x), k2 = f(t + h / 2, x + h / 2 * k1), k3 = f(t + h / 2, x + h / 2 * k2),
                          k4 = f(t + h, x + h * k3);
    x += h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    q.col(k / kParts) = x.head(n);
  }
  return q;
}

/// Whether the law, after its run, answers other than one that has just been reset.
bool hasState(const Situation& s, int steps) {
  ClosedLoop loop(s.robot, s.freshLaw(), kDuration / steps, s.start, s.reference);
  loop.Ke_N_per_m = s.Ke_N_per_m;
  loop.run(kDuration);
  return effort(s, *loop.law, kDuration, loop.q(), loop.input.state.qd) !=
         effort(s, *s.freshLaw(), kDuration, loop.q(), loop.input.state.qd);
}

double largest(const Eigen::MatrixXd& difference) { return difference.cwiseAbs().maxCoeff(); }

/// That errors at dt, dt/2 and dt/4 are of this order. With the next one they are c dt^p (1 + k lambda dt), and k of
/// the size of p: the first ratio is 2^p within 2^p p lambda dt / 2, the second is twice as near.
void expectOrder(int p, double one, double half, double quarter) {
  const double ratio = std::pow(2.0, p), spread = ratio * p * kStepTimesPole / 2.0;
  EXPECT_NEAR(one / half, ratio, spread);
  EXPECT_NEAR(half / quarter, ratio, spread / 2.0);
}

class Convergence : public testing::TestWithParam<Situation> {};

TEST_P(Convergence, SampledLawTendsToTheContinuousOneInFirstOrder) {
  const Situation& s = GetParam();
  const int steps = stepsOf(s);
  const Eigen::MatrixXd one = sampled(s, steps, 1), half = sampled(s, steps, 2), quarter = sampled(s, steps, 4);
  if (hasState(s, steps)) {
    // Its state is its own, so nobody can evaluate it between steps. Much finer steps stand for the limit, and two of
    // them, extrapolated, are without their own error of first order. That it converges is seen, not to what.
    const Eigen::MatrixXd limit = 2.0 * sampled(s, steps, 32) - sampled(s, steps, 16);
    expectOrder(1, largest(one - limit), largest(half - limit), largest(quarter - limit));
    return;
  }
  const Eigen::MatrixXd limit = continuous(s, steps);
  expectOrder(1, largest(one - limit), largest(half - limit), largest(quarter - limit));

  // That half a step's delay is all there is: of the same law half a step late the sampled one is a second order away.
  const double dt_s = kDuration / steps;
  expectOrder(2, largest(one - continuous(s, steps, dt_s / 2)), largest(half - continuous(s, steps, dt_s / 4)),
              largest(quarter - continuous(s, steps, dt_s / 8)));
}

INSTANTIATE_TEST_SUITE_P(AllLaws, Convergence, testing::ValuesIn(situations()),
                         [](const testing::TestParamInfo<Situation>& one) { return one.param.name; });

/// e of e'' + kd e' + kp e = 0.
double freeResponse(double kp, double kd, double e0, double ed0, double t) {
  using Complex = std::complex<double>;
  const Complex root = std::sqrt(Complex(kd * kd / 4.0 - kp));
  const Complex slow = -kd / 2.0 + root, fast = -kd / 2.0 - root;
  const Complex a = (ed0 - fast * e0) / (slow - fast);
  return (a * std::exp(slow * t) + (e0 - a) * std::exp(fast * t)).real();
}

/// Laws that make the error linear, e'' + Kd e' + Kp e = 0 whatever the motion: in the joints, or at the tip.
void expectClosedForm(const std::string& law, const std::function<Vector3(const Reference&)>& wanted,
                      const std::function<Vector3(const Reference&)>& speed,
                      const std::function<Vector3(const JointVector& q)>& actual) {
  const std::vector<Situation> all = situations();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Situation& one) { return one.name == law + "_free"; });
  ASSERT_NE(found, all.end());
  const Situation& s = *found;
  const ParameterValues defaults = completeParameters(findLaw(law).parameters, {}, 3);
  const Numbers &kp = numbers(defaults, "kp"), &kd = numbers(defaults, "kd");

  const int steps = stepsOf(s);
  const Vector3 e0 = wanted(s.reference(0.0)) - actual(s.start), ed0 = speed(s.reference(0.0));
  const auto difference = [&](const Eigen::MatrixXd& q) {
    double worst = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double t = kDuration * (k + 1) / steps;
      const Vector3 e = wanted(s.reference(t)) - actual(q.col(k));
      for (int i = 0; i < 3; ++i)
        worst = std::max(worst, std::abs(e(i) - freeResponse(kp[i], kd[i], e0(i), ed0(i), t)));
    }
    return worst;
  };
  const double one = difference(sampled(s, steps, 1)), half = difference(sampled(s, steps, 2)),
               quarter = difference(sampled(s, steps, 4));
  expectOrder(1, one, half, quarter);
  EXPECT_LT(difference(continuous(s, steps)), 1e-4 * quarter);  // no more than its integration
}

TEST(ConvergenceToTheClosedForm, OfJointInverseDynamics) {
  expectClosedForm(
      "joint_inverse_dynamics", [](const Reference& ref) -> Vector3 { return ref.q; },
      [](const Reference& ref) -> Vector3 { return ref.qd; }, [](const JointVector& q) -> Vector3 { return q; });
}

TEST(ConvergenceToTheClosedForm, OfOperationalInverseDynamics) {
  expectClosedForm(
      "operational_inverse_dynamics", [](const Reference& ref) -> Vector3 { return ref.X_WE.p; },
      [](const Reference& ref) -> Vector3 { return ref.V_WE.head<3>(); },
      [robot = rppRobot()](const JointVector& q) -> Vector3 { return tipPose(robot, q).p; });
}

}  // namespace
}  // namespace baton
