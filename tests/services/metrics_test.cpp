#include "report/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/robots.hpp"

namespace baton::test {
namespace {

constexpr double kStep_s = 1e-3;

/// A trace of one revolute joint, everything zero.
Trace emptyTrace(Eigen::Index steps) {
  Trace trace;
  trace.scenario.robot = rppRobot();
  trace.scenario.robot.joints.resize(1);
  trace.scenario.step_ns = 1'000'000;
  for (Eigen::MatrixXd* joints : {&trace.q, &trace.qd, &trace.tau, &trace.q_d, &trace.qd_d, &trace.qdd_d})
    *joints = Eigen::MatrixXd::Zero(1, steps);
  for (Eigen::MatrixXd* three : {&trace.p_WE, &trace.orientation, &trace.zyz, &trace.zyz_d})
    *three = Eigen::MatrixXd::Zero(3, steps);
  trace.p_WE_d = Eigen::MatrixXd::Constant(3, steps, std::numeric_limits<double>::quiet_NaN());
  trace.h_e = trace.h_d = Eigen::MatrixXd::Zero(6, steps);
  return trace;
}

/// q follows `response` towards q_d.
template <class Response>
ErrorMetrics metricsOfResponse(double duration_s, double q_d, const Response& response) {
  const auto steps = static_cast<Eigen::Index>(std::lround(duration_s / kStep_s)) + 1;
  Trace trace = emptyTrace(steps);
  trace.q_d.setConstant(q_d);
  for (Eigen::Index k = 0; k < steps; ++k) trace.q(0, k) = response(static_cast<double>(k) * kStep_s);
  const Metrics metrics = metricsOf(trace);
  EXPECT_EQ(metrics.joints.size(), 1U);
  return metrics.joints.at(0);
}

TEST(Metrics, OfAFirstOrderResponse) {
  // e = a exp(-t): every integral is known.
  const double a = 0.5;
  const double T = 10.0;
  const ErrorMetrics m = metricsOfResponse(T, a, [&](double t) { return a * (1.0 - std::exp(-t)); });
  EXPECT_EQ(m.name, "q1");
  EXPECT_EQ(m.unit, "rad");
  EXPECT_NEAR(m.final, a * std::exp(-T), 1e-12);
  EXPECT_NEAR(m.peak, a, 1e-12);
  EXPECT_NEAR(m.iae, a * (1.0 - std::exp(-T)), 1e-6);
  EXPECT_NEAR(m.rms, a * std::sqrt((1.0 - std::exp(-2.0 * T)) / (2.0 * T)), 1e-6);
  EXPECT_DOUBLE_EQ(m.overshoot, 0.0);
  EXPECT_NEAR(m.settling_s, std::log(50.0), kStep_s);
}

TEST(Metrics, OvershootOfASecondOrderResponseInBothDirections) {
  const double zeta = 0.3;
  const double omega = 8.0;
  const double damped = omega * std::sqrt(1.0 - zeta * zeta);
  const double expected = std::exp(-zeta * M_PI / std::sqrt(1.0 - zeta * zeta));
  for (const double goal : {0.7, -0.7}) {
    const ErrorMetrics m = metricsOfResponse(6.0, goal, [&](double t) {
      return goal * (1.0 - std::exp(-zeta * omega * t) *
                               (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t)));
    });
    EXPECT_NEAR(m.overshoot, expected, 1e-4) << goal;
    EXPECT_GT(m.settling_s, 0.0);
    EXPECT_LT(m.settling_s, std::log(50.0) / (zeta * omega) + 1.0 / omega) << "the envelope bounds it";
  }
}

TEST(Metrics, WhatNeverSettlesSaysSo) {
  const ErrorMetrics m = metricsOfResponse(2.0, 1.0, [](double t) { return 0.5 * t / 2.0; });
  EXPECT_TRUE(std::isnan(m.settling_s));
  EXPECT_NEAR(m.final, 0.5, 1e-12);
}

TEST(Metrics, WithoutAStrokeThereIsNoOvershoot) {
  const ErrorMetrics m = metricsOfResponse(1.0, 0.25, [](double t) { return 0.25 + 0.01 * std::sin(2.0 * M_PI * t); });
  EXPECT_TRUE(std::isnan(m.overshoot));
  EXPECT_TRUE(std::isnan(m.settling_s));
  EXPECT_NEAR(m.peak, 0.01, 1e-6);
  EXPECT_NEAR(m.rms, 0.01 / std::sqrt(2.0), 1e-6);
}

TEST(Metrics, EffortsCountTheTimeAtTheLimit) {
  Trace trace = emptyTrace(1001);
  trace.scenario.robot.joints[0].effort_limit = 2.0;
  for (Eigen::Index k = 0; k < 1001; ++k) trace.tau(0, k) = k <= 250 ? -2.0 : 0.5;
  const Metrics metrics = metricsOf(trace);
  ASSERT_EQ(metrics.efforts.size(), 1U);
  EXPECT_DOUBLE_EQ(metrics.efforts[0].peak, 2.0);
  EXPECT_NEAR(metrics.efforts[0].saturated_s, 0.25, 1e-12) << "tau at step k was applied from k - 1 to k";
}

TEST(Metrics, ForcesKeepTheirSign) {
  Trace trace = emptyTrace(100);
  trace.scenario.walls.push_back({});
  trace.h_e(2, 40) = -7.0;
  trace.h_e(2, 60) = 5.0;
  trace.h_e(2, 99) = 3.0;
  const Metrics metrics = metricsOf(trace);
  EXPECT_DOUBLE_EQ(metrics.peak_force_N.z(), -7.0);
  EXPECT_DOUBLE_EQ(metrics.final_force_N.z(), 3.0);
}

TEST(Metrics, WithoutARecordedContactThereIsNoForce) {
  Trace trace = emptyTrace(100);
  trace.h_e.setConstant(std::numeric_limits<double>::quiet_NaN());
  const Metrics metrics = metricsOf(trace);
  EXPECT_TRUE(metrics.final_force_N.array().isNaN().all());
  EXPECT_TRUE(metrics.peak_force_N.array().isNaN().all());
  EXPECT_TRUE(toJson(metrics).at("force_N").at("peak").at(2).is_null());
  EXPECT_NE(toText(metrics).find("final - - -   peak - - -"), std::string::npos) << toText(metrics);
}

TEST(Metrics, StepsThatWereNotRecordedAreCountedAndTold) {
  Trace trace = emptyTrace(100);
  trace.q_d.setConstant(0.5);
  for (Eigen::MatrixXd* signal : {&trace.q, &trace.tau}) signal->col(40).setConstant(std::nan(""));
  trace.q_d.col(99).setConstant(std::nan(""));
  const Metrics metrics = metricsOf(trace);
  EXPECT_EQ(metrics.unrecorded_steps, 2U);
  ASSERT_EQ(metrics.joints.size(), 1U) << "there is a reference, if not at the last step";
  EXPECT_TRUE(std::isnan(metrics.joints[0].rms));
  EXPECT_DOUBLE_EQ(metrics.joints[0].peak, 0.5);
  EXPECT_EQ(toText(metrics).find("0 steps were not recorded"), std::string::npos);
  EXPECT_NE(toText(metrics).find("2 steps were not recorded"), std::string::npos) << toText(metrics);
}

TEST(Metrics, TheDurationOfABranchIsItsOwn) {
  Trace trace = emptyTrace(101);
  trace.first_step = 400;
  EXPECT_NEAR(metricsOf(trace).duration_s, 0.1, 1e-12);
}

TEST(Metrics, WhatBeganBeforeTheRecordingHasNoOvershoot) {
  // Almost there when the recording begins: of that last bit an overshoot would be many times itself.
  Trace trace = emptyTrace(101);
  trace.first_step = 400;
  trace.q_d.setConstant(1.0);
  trace.q.setConstant(1.0 + 1e-4);
  trace.q(0, 0) = 1.0 - 1e-6;
  trace.p_WE_d.setConstant(1.0);
  const Metrics metrics = metricsOf(trace);
  for (const ErrorMetrics& one : {metrics.joints.at(0), metrics.task.at(2)}) {
    EXPECT_TRUE(std::isnan(one.overshoot)) << one.name;
    EXPECT_TRUE(std::isnan(one.settling_s)) << one.name;
    EXPECT_TRUE(std::isfinite(one.rms)) << one.name;
  }
}

TEST(Metrics, AMotionGivenInTaskSpaceHasNoJointErrors) {
  Trace trace = emptyTrace(11);
  trace.q_d.setConstant(std::numeric_limits<double>::quiet_NaN());
  trace.p_WE_d.setZero();
  trace.p_WE.row(1).setConstant(0.002);
  const Metrics metrics = metricsOf(trace);
  EXPECT_TRUE(metrics.joints.empty());
  ASSERT_EQ(metrics.task.size(), 4U);
  EXPECT_NEAR(metrics.task[1].final, -0.002, 1e-15) << "desired minus actual";
  EXPECT_EQ(toJson(metrics).at("task").at(1).at("name"), "y");
  EXPECT_NE(toText(metrics).find("y [m]"), std::string::npos);
}

}  // namespace
}  // namespace baton::test
