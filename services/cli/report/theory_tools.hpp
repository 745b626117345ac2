/// What the checks of theory.cpp share: parameters by name, equilibria by Newton's iteration, motions by integration.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "control/parameters.hpp"
#include "theory.hpp"
#include "trajectory/trajectory.hpp"

namespace baton::theory {

// --- parts of a scenario

[[nodiscard]] const ControllerConfig& controllerOf(const Trace& trace);
/// Throws UsageError unless the run's law is one of these.
void expectLaw(const Trace& trace, const std::vector<std::string>& laws);
/// A parameter of the run's law.
template <typename Vector>
[[nodiscard]] Vector gain(const Trace& trace, const std::string& name) {
  return vector<Vector>(controllerOf(trace).parameters, name);
}
[[nodiscard]] const std::string& option(const Trace& trace, const std::string& name);

/// The last step that was acted on: everything about it was waited for, so everything about it is recorded.
[[nodiscard]] Eigen::Index restStep(const Trace& trace);
/// The reference at the time of a step, from the scenario.
[[nodiscard]] Reference referenceAt(const Trace& trace, Eigen::Index step);
[[nodiscard]] Reference goalOf(const Trace& trace);
/// What is desired without the noise on it.
[[nodiscard]] Trajectory quietTrajectory(const Scenario& scenario);
/// Wall by wall, stiffness x depth along the normal: h_e at rest [N].
[[nodiscard]] Vector3 wallForce(const Scenario& scenario, const Vector3& p);

// --- the arm

[[nodiscard]] JointVector gravity(const RobotModel& robot, const JointVector& q);
[[nodiscard]] JointMatrix inertia(const RobotModel& robot, const JointVector& q);
/// J_P at q, 3 x n.
[[nodiscard]] Eigen::MatrixXd positionJacobian(const RobotModel& robot, const JointVector& q);

/// The task error [p_d - p; ZYZ angles, each the short way round] and its derivative, by differences of positions and
/// angles: -d(error)/dq is J_A.
[[nodiscard]] Vector6 zyzTaskError(const Reference& goal, const RobotModel& robot, const JointVector& q);
[[nodiscard]] Eigen::MatrixXd zyzTaskJacobian(const Reference& goal, const RobotModel& robot, const JointVector& q);

// --- solving

/// Newton's iteration with a numeric Jacobian. Entries are NaN when it does not converge, so that no check passes.
using Residual = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
[[nodiscard]] Eigen::VectorXd solve(const Residual& residual, const Eigen::VectorXd& start);
[[nodiscard]] Eigen::MatrixXd slope(const Residual& residual, const Eigen::VectorXd& x);

/// x'(t) = derivative(t, x) by RK4 from x(0), `substeps` to a step of the run; a column a step.
using Derivative = std::function<Eigen::VectorXd(double time_s, const Eigen::VectorXd& x)>;
[[nodiscard]] Eigen::MatrixXd integrate(const Trace& trace, const Derivative& derivative, const Eigen::VectorXd& start,
                                        int substeps);

/// The motion of the arm under an effort that is a function of time and state, cut at the joints' limits, in continuous
/// time; the walls of the scenario push back. q and qd at every step, 2n x steps.
using Effort = std::function<JointVector(const Reference& reference, const JointVector& q, const JointVector& qd)>;
[[nodiscard]] Eigen::MatrixXd motionUnder(const Trace& run, const Effort& effort);

/// m e'' + d e' + k e = 0 from e(0), e'(0), in closed form.
struct FreeResponse {
  double e = 0.0;
  double ed = 0.0;
};
[[nodiscard]] FreeResponse freeResponse(double m, double d, double k, const FreeResponse& start, double time_s);

/// The largest of what is added, from zero; NaN once something is, so that what was not recorded does not go unnoticed.
class Largest {
 public:
  void add(double value) {
    if (!(value <= value_) && !std::isnan(value_)) value_ = value;
  }
  operator double() const { return value_; }  // NOLINT(google-explicit-constructor): it is that number

 private:
  double value_ = 0.0;
};

// --- checks

/// 1e-4 of the prediction, or 1e-6 where it is zero.
[[nodiscard]] Check atRest(std::string what, std::string unit, double predicted, double measured);
[[nodiscard]] Check within(std::string what, std::string unit, double predicted, double measured, double tolerance);
[[nodiscard]] Check relative(std::string what, std::string unit, double predicted, double measured, double tolerance);

/// The force on each wall along its normal, at rest: predicted with the tip at p, measured at the end.
[[nodiscard]] std::vector<Check> wallForcesAtRest(const Trace& trace, const Vector3& p);

[[nodiscard]] std::string jointName(int i);                           // "q1"
[[nodiscard]] std::string jointUnit(const RobotModel& robot, int i);  // rad or m
[[nodiscard]] std::string effortUnit(const RobotModel& robot, int i);
inline constexpr const char* kAxes[] = {"x", "y", "z"};

// --- the checks, by subject; theory.cpp has the table of their names

struct Inputs {
  const Trace& run;
  const Trace* other = nullptr;  // the second run; there when the check asks for one
};
using Checks = std::vector<Check>;

// theory_joint.cpp
[[nodiscard]] Checks reachesGoal(const Inputs& in);
[[nodiscard]] Checks decayRate(const Inputs& in);
[[nodiscard]] Checks gravityOffset(const Inputs& in);
[[nodiscard]] Checks noiseResponse(const Inputs& in);
[[nodiscard]] Checks massScaleOffset(const Inputs& in);
[[nodiscard]] Checks settlesAfterMotion(const Inputs& in);
[[nodiscard]] Checks biasOffset(const Inputs& in);
[[nodiscard]] Checks uncompensatedOffset(const Inputs& in);
[[nodiscard]] Checks firstTorque(const Inputs& in);
[[nodiscard]] Checks settling(const Inputs& in);

// theory_tracking.cpp
[[nodiscard]] Checks secondOrderError(const Inputs& in);
[[nodiscard]] Checks tracks(const Inputs& in);
[[nodiscard]] Checks adaptationEffect(const Inputs& in);
[[nodiscard]] Checks adaptationLearns(const Inputs& in);

// theory_task.cpp
[[nodiscard]] Checks taskGoal(const Inputs& in);
[[nodiscard]] Checks noContact(const Inputs& in);
[[nodiscard]] Checks angleJump(const Inputs& in);
[[nodiscard]] Checks spuriousEquilibrium(const Inputs& in);
[[nodiscard]] Checks taskBalance(const Inputs& in);
[[nodiscard]] Checks complianceForce(const Inputs& in);

// theory_force.cpp
[[nodiscard]] Checks impedanceBalance(const Inputs& in);
[[nodiscard]] Checks printedImpedanceBalance(const Inputs& in);
[[nodiscard]] Checks unforcedImpedanceBalance(const Inputs& in);
[[nodiscard]] Checks admittanceBalance(const Inputs& in);
[[nodiscard]] Checks forceGoal(const Inputs& in);
[[nodiscard]] Checks forceDrift(const Inputs& in);
[[nodiscard]] Checks parallelGoal(const Inputs& in);

// theory_coupling.cpp
[[nodiscard]] Checks sameBytesInOneProcess(const Inputs& in);
[[nodiscard]] Checks couplingGrowth(const Inputs& in);

}  // namespace baton::theory
