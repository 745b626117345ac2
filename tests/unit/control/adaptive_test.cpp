#include <gtest/gtest.h>

#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;
using Numbers = std::vector<double>;

constexpr double kLambda = 100.0, kKd = 500.0, kK = 30.2;         // the report's values and the law's defaults
constexpr double kStep = 1e-4;                                    // s
constexpr double kInertia = 0.1, kFriction = 0.2;                 // of the report's link
constexpr double kWeight = 1.1 * 1.1 * 3.5 * 2.7 * 9.806 * 1.75;  // its m g d [N m]

/// q_d = (pi/3) sin t.
Reference swing(double t) {
  Reference reference;
  reference.q = JointVector::Constant(1, kPi / 3 * std::sin(t));
  reference.qd = JointVector::Constant(1, kPi / 3 * std::cos(t));
  reference.qdd = -reference.q;
  return reference;
}

ClosedLoop linkLoop(const ParameterValues& parameters, double dt_s = kStep) {
  const RobotModel link = link1Robot();
  return {link, makeLaw("adaptive", link, parameters), dt_s, JointVector::Constant(1, 0.3), swing};
}

/// Largest tracking error between two times [rad].
double worstError(ClosedLoop& loop, double from_s, double to_s) {
  double worst = 0.0;
  while (loop.time_s < to_s) {
    EXPECT_TRUE(loop.step()) << loop.time_s;
    if (loop.time_s >= from_s) worst = std::max(worst, std::abs(swing(loop.time_s).q(0) - loop.q()(0)));
  }
  return worst;
}

TEST(Adaptive, IsTheReportsLawOnTheReportsLink) {
  // tau = Y Th + Kd s with Y = (qdd_r, qd_r, sin q), Th = (I, F, m g d), written out.
  for (const double k : {kK, 0.01}) {
    ClosedLoop loop = linkLoop({{"k", Numbers{k}}, {"lambda", Numbers{20.0}}, {"kd", Numbers{100.0}}});
    Vector3 estimate = Vector3::Zero();
    for (int i = 0; i < 20000; ++i) {
      const Reference ref = swing(loop.time_s);
      const double q = loop.q()(0), qd = loop.input.state.qd(0);
      const double qd_r = ref.qd(0) + 20.0 * (ref.q(0) - q), qdd_r = ref.qdd(0) + 20.0 * (ref.qd(0) - qd);
      const double s = qd_r - qd;
      const Vector3 Y(qdd_r, qd_r, std::sin(q));
      const double expected = Y.dot(estimate) + 100.0 * s;
      ASSERT_TRUE(loop.step());
      ASSERT_NEAR(loop.tau(0), expected, 1e-9 * (1.0 + std::abs(expected))) << k << " " << i;
      estimate += kStep / k * s * Y / (1.0 + kStep / k * Y.squaredNorm() / 100.0);
    }
    EXPECT_GT(estimate.norm(), k == kK ? 1e-4 : 100.0);
  }
}

TEST(Adaptive, WithTheReportsGainTheAdaptationIsInert) {
  ClosedLoop on = linkLoop({}), off = linkLoop({{"adaptation", "off"}});
  const double with = worstError(on, 10.0, 20.0), without = worstError(off, 10.0, 20.0);
  EXPECT_NEAR(with, without, 2e-3 * without);
  // What is left is a PD's: the weight over its stiffness lam Kd, at the end of the swing.
  EXPECT_NEAR(without, kWeight * std::sin(kPi / 3) / (kLambda * kKd), 0.01 * without);
}

TEST(Adaptive, ATunedGainLearns) {
  const ParameterValues tuned = {{"k", Numbers{0.005}}, {"lambda", Numbers{20.0}}, {"kd", Numbers{100.0}}};
  ParameterValues fixed = tuned;
  fixed["adaptation"] = "off";
  ClosedLoop on = linkLoop(tuned), off = linkLoop(fixed);
  const double at_first = worstError(on, 1.0, 5.0), at_last = worstError(on, 15.0, 20.0);
  EXPECT_LT(at_last, 1e-2 * at_first);
  EXPECT_LT(at_last, 2e-3 * worstError(off, 15.0, 20.0));
}

TEST(Adaptive, TheOtherReadingOfTheReportLearnsFasterAndStaysStableAtItsStep) {
  ClosedLoop loop = linkLoop({{"adaptation", "times_k"}});
  const double at_first = worstError(loop, 1.0, 5.0);
  EXPECT_LT(worstError(loop, 15.0, 20.0), 0.9 * at_first);
}

TEST(Adaptive, LinkOfKnownParametersObeysItsFirstOrderEquation) {
  // I s' + (F + Kd) s = 0: the law's promise with the true parameters. Half the step, half the discrepancy.
  const auto discrepancy = [](double dt_s) {
    const double lambda = 5.0, kd = 2.0;
    ClosedLoop loop = linkLoop(
        {{"initial_scale", Numbers{1.0}}, {"adaptation", "off"}, {"lambda", Numbers{lambda}}, {"kd", Numbers{kd}}},
        dt_s);
    const auto s = [&] {
      const Reference ref = swing(loop.time_s);
      return ref.qd(0) - loop.input.state.qd(0) + lambda * (ref.q(0) - loop.q()(0));
    };
    const double s0 = s();
    double largest = 0.0;
    while (loop.time_s < 0.5) {
      EXPECT_TRUE(loop.step());
      largest = std::max(largest, std::abs(s() - s0 * std::exp(-(kFriction + kd) / kInertia * loop.time_s)));
    }
    return largest;
  };
  const double one = discrepancy(2e-4), half = discrepancy(1e-4), quarter = discrepancy(5e-5);
  EXPECT_LT(half, 0.02);
  EXPECT_NEAR(one / half, 2.0, 0.1);
  EXPECT_NEAR(half / quarter, 2.0, 0.1);
}

/// A motion of the RPP arm that asks for all its parameters.
Reference weave(const RobotModel& robot, double t) {
  Vector3 q, qd, qdd;
  for (int i = 0; i < 3; ++i) {
    const double amplitude = i == 0 ? 0.5 : 0.1, w = 1.0 + 0.5 * i;
    q(i) = amplitude * std::sin(w * t);
    qd(i) = amplitude * w * std::cos(w * t);
    qdd(i) = -w * w * q(i);
  }
  return referenceOf(robot, q, qd, qdd);
}

ClosedLoop rppLoop(const ParameterValues& changes, double dt_s = kStep) {
  const RobotModel robot = rppRobot();
  ParameterValues parameters = {{"lambda", Numbers{10.0}}, {"kd", Numbers{10.0, 20.0, 10.0}}, {"k", Numbers{0.1}}};
  for (const auto& [name, value] : changes) parameters[name] = value;
  return {robot, makeLaw("adaptive", robot, parameters), dt_s, Vector3(0.1, 0.02, 0.02),
          [robot](double t) { return weave(robot, t); }};
}

double lastError(ClosedLoop& loop) {
  loop.run(15.0);
  double worst = 0.0;
  for (int k = 0; k < 50000; ++k) {
    EXPECT_TRUE(loop.step());
    worst = std::max(worst, (loop.reference(loop.time_s).q - loop.q()).norm());
  }
  return worst;
}

TEST(Adaptive, LearnsTheWholeArmFromNothing) {
  ClosedLoop off = rppLoop({{"adaptation", "off"}});
  const double without = lastError(off);
  for (const char* unknowns : {"nonzero", "all"}) {
    ClosedLoop on = rppLoop({{"unknowns", unknowns}});
    EXPECT_LT(lastError(on), 0.03 * without) << unknowns;
  }
}

TEST(Adaptive, LyapunovsFunctionFallsAtTheRateOfItsDamping) {
  // With the true parameters V = s^T B s / 2 loses s^T Kd s, for C is Christoffel's and v is not qd. Friction joins in.
  const auto imbalance = [](double dt_s) {
    ClosedLoop loop = rppLoop({{"initial_scale", Numbers{1.0}}, {"adaptation", "off"}}, dt_s);
    for (Joint& joint : loop.model.joints) joint.friction.viscous = 3.0;
    loop.law = makeLaw("adaptive", loop.model,
                       {{"initial_scale", Numbers{1.0}},
                        {"adaptation", "off"},
                        {"lambda", Numbers{10.0}},
                        {"kd", Numbers{10.0, 20.0, 10.0}}});
    const JointVector damping = Vector3(13.0, 23.0, 13.0);
    const auto s = [&]() -> JointVector {
      const Reference ref = loop.reference(loop.time_s);
      return ref.qd - loop.input.state.qd + 10.0 * (ref.q - loop.q());
    };
    const auto V = [&] { return 0.5 * s().dot(massMatrixAt(loop.model, loop.q()) * s()); };
    const double start = V();
    double lost = 0.0;
    while (loop.time_s < 1.0) {
      const double before = s().dot(damping.cwiseProduct(s()));
      EXPECT_TRUE(loop.step());
      lost += 0.5 * dt_s * (before + s().dot(damping.cwiseProduct(s())));
    }
    return std::abs(V() + lost - start) / start;
  };
  const double one = imbalance(1e-4), half = imbalance(5e-5);
  EXPECT_LT(half, 0.05);
  EXPECT_NEAR(one / half, 2.0, 0.2);
}

TEST(Adaptive, KeepsItsEstimateOverAHandoverAndDoesNotLearnStandingBy) {
  ClosedLoop loop = rppLoop({});
  loop.run(5.0);
  const LawInput input = loop.input;
  const auto effort = [&] {
    JointVector tau;
    loop.law->handover(input);
    EXPECT_EQ(loop.law->step(input, tau), LawStatus::kOk);
    return tau;
  };
  const JointVector at_once = effort();
  for (int k = 0; k < 1000; ++k) (void)effort();
  EXPECT_EQ(effort(), at_once);
  // It is the learnt estimate: a law that knows nothing commands something else.
  JointVector of_a_novice;
  ASSERT_EQ(rppLoop({}).law->step(input, of_a_novice), LawStatus::kOk);
  EXPECT_GT((of_a_novice - at_once).norm(), 0.5);
}

TEST(Adaptive, DoesNotWindUpAgainstAnEffortLimit) {
  // A link too weak to follow the swing, then strong again. Returns the largest error in the second after that.
  const auto overshoot = [](bool knows_limit) {
    RobotModel weak = link1Robot();
    weak.joints[0].effort_limit = 100.0;  // the weight at the end of the swing is 170 N m
    const ParameterValues tuned = {{"k", Numbers{0.005}}, {"lambda", Numbers{20.0}}, {"kd", Numbers{100.0}}};
    ClosedLoop loop(weak, makeLaw("adaptive", knows_limit ? weak : link1Robot(), tuned), kStep,
                    JointVector::Constant(1, 0.0), swing);
    loop.run(12.0);
    loop.model.joints[0].effort_limit = 1e9;
    return worstError(loop, 12.0, 13.0);
  };
  EXPECT_LT(2.0 * overshoot(true), overshoot(false));
}

TEST(Adaptive, KnowingNothingItIsAPdOnS) {
  const RobotModel robot = rppRobot();
  const auto law = makeLaw("adaptive", robot, {});
  std::mt19937 generator(140);
  for (int i = 0; i < 20; ++i) {
    LawInput input;
    input.dt_s = kStep;
    input.state = stateOf(robot, randomJointVector(generator, 3, 0.5), randomJointVector(generator, 3, 1.0));
    input.reference = sineReference(robot, i);
    law->reset();
    JointVector tau;
    ASSERT_EQ(law->step(input, tau), LawStatus::kOk);
    const JointVector s = input.reference.qd - input.state.qd + kLambda * (input.reference.q - input.state.q);
    EXPECT_LT((tau - kKd * s).norm(), 1e-9 * s.norm());
  }
}

}  // namespace
}  // namespace baton
