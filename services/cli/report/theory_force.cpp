/// Checks of laws in contact that feel the force: impedance, admittance, force, parallel force/position. h_e and f_e
/// are what the tip exerts on the environment, from the walls of the scenario.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "environment/plane.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "robot/simulation.hpp"
#include "theory_tools.hpp"

namespace baton::theory {
namespace {

/// The tip's errors and the force on the walls, at rest at p.
Checks balance(const Trace& run, const Vector3& p) {
  const Vector3 error = goalOf(run).X_WE.p - p;
  const Eigen::Index k = restStep(run);
  Checks checks;
  for (int i = 0; i < 3; ++i) {
    checks.push_back(
        atRest(std::string("error of ") + kAxes[i] + " at rest", "m", error(i), run.p_WE_d(i, k) - run.p_WE(i, k)));
  }
  for (Check& force : wallForcesAtRest(run, p)) checks.push_back(std::move(force));
  return checks;
}

/// The tip's acceleration under a force on it, J_P B^-1 J_P^T, 1/kg.
Matrix3 mobility(const RobotModel& robot, const JointVector& q) {
  const Eigen::MatrixXd J = positionJacobian(robot, q);
  return J * inertia(robot, q).llt().solve(JointMatrix(J.transpose()));
}

/// The acceleration that a law wants of the tip at a step, from what it is told then; it may remember.
using Wish = std::function<Vector3(const Reference& reference, const Vector3& p, const Vector3& v, const Vector3& h_e)>;

/// Largest distance of the tip from where it is when this is asked of it once a step, and what that takes is held:
///   tau = B y + n + J_P^T h_e,   J_P y = wish - J_P' qd.
/// Not theory of continuous time but the same equation sampled, so that only rounding is left between the two, and
/// every gain is seen.
Check sampledTip(const Trace& run, const Wish& wish) {
  constexpr double kRounding_m = 1e-9;
  const Scenario& scenario = run.scenario;
  const RobotModel& robot = scenario.robot;
  const Trajectory trajectory(robot, scenario.trajectory);
  JointVector q = scenario.start_q, qd = scenario.start_qd, tau;
  Reference wanted;
  Kinematics kinematics;
  Largest worst;
  for (Eigen::Index k = 0; k <= restStep(run); ++k) {
    computeKinematics(robot, q, qd, kinematics);
    const Vector3 p = kinematics.X_WE.p, v = kinematics.V_WE.head<3>();
    worst.add((p - run.p_WE.col(k)).norm());
    trajectory.evaluate(run.time(k), wanted);
    const Contact contact = planesContact(scenario.walls, p, v);
    const Vector3 a = wish(wanted, p, v, contact.h_e.head<3>()) - kinematics.Jdot_qd.head<3>();
    const Matrix3 J_P = kinematics.J.topRows<3>();
    inverseDynamics(robot, q, qd, J_P.partialPivLu().solve(a), contact.h_e, tau);
    if (!integrateStep(robot, tau, contact, scenario.stepSeconds(), scenario.substeps, q, qd)) worst.add(std::nan(""));
  }
  return within("largest distance from the same equation acting once a step", "m", 0.0, worst, kRounding_m);
}

/// A tip that gives way as m z'' + d z' + k z = h_e at x = x_d - z: where it rests, and what happens on the way.
/// There the wall's force is cancelled half a step late: half a step's travel in contact times Ke, felt through the
/// arm's mobility and held by a loop of this stiffness [1/s^2], comes on top of the travel itself.
Checks yieldingTip(const Trace& run, const Vector3& m, const Vector3& d, const Vector3& k, double loop_stiffness) {
  constexpr int kSubsteps = 2;
  const Scenario& scenario = run.scenario;
  const Vector3 goal = goalOf(run).X_WE.p;
  const Vector3 z_rest = solve(
      [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
        return k.cwiseProduct(Vector3(z)) - wallForce(scenario, goal - z);
      },
      Vector3::Zero());
  Checks checks = balance(run, goal - z_rest);

  const Trajectory trajectory(scenario.robot, scenario.trajectory);
  const auto derivative = [&](double time_s, const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Reference wanted;
    trajectory.evaluate(time_s, wanted);
    const Vector3 z = x.head<3>(), zd = x.tail<3>(), h_e = wallForce(scenario, wanted.X_WE.p - z);
    Vector6 xd;
    xd << zd, (h_e - d.cwiseProduct(zd) - k.cwiseProduct(z)).cwiseQuotient(m);
    return xd;
  };
  const Eigen::MatrixXd motion = integrate(run, derivative, Vector6::Zero(), kSubsteps);
  Largest predicted, measured, worst, travel, travel_in_contact;
  Vector3 before = referenceAt(run, 0).X_WE.p;
  for (Eigen::Index step = 0; step <= restStep(run); ++step) {
    const Vector3 p = referenceAt(run, step).X_WE.p - motion.col(step).head<3>();
    const double force = wallForce(scenario, p).norm();
    predicted.add(force);
    measured.add(run.h_e.col(step).head<3>().norm());
    worst.add((p - run.p_WE.col(step)).norm());
    travel.add((p - before).norm());
    if (force > 0.0) travel_in_contact.add((p - before).norm());
    before = p;
  }
  double felt = 0.0, Ke = 0.0;
  for (const PlaneSpec& wall : scenario.walls) {
    Ke += wall.stiffness_N_per_m;
    felt += wall.stiffness_N_per_m * (mobility(scenario.robot, goalOf(run).q) * wall.normal.normalized()).norm();
  }
  const double late = travel_in_contact / 2.0 * felt / loop_stiffness;
  checks.push_back(within("largest force on the way", "N", predicted, measured, Ke * (travel_in_contact / 2.0 + late)));
  checks.push_back(
      within("largest distance of the tip from m z'' + d z' + k z = h_e", "m", 0.0, worst, travel / 2.0 + late));
  return checks;
}

/// Kp x~ = c Md J_P B^-1 J_P^T h_e: the wrench the law does not cancel, through the arm's own inertia.
Checks throughTheArm(const Trace& run, const char* form, double c) {
  expectLaw(run, {"impedance"});
  if (option(run, "form") != form) {
    throw UsageError("run " + run.scenario.name + ": expected form " + form + " for this check, found " +
                     option(run, "form"));
  }
  const RobotModel& robot = run.scenario.robot;
  const Vector3 goal = goalOf(run).X_WE.p;
  const Vector3 md = gain<Vector6>(run, "md").head<3>(), kp = gain<Vector6>(run, "kp").head<3>();
  const Eigen::VectorXd q = solve(
      [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        const Vector3 p = tipPose(robot, x).p;
        return kp.cwiseProduct(goal - p) -
               c * md.cwiseProduct(Vector3(mobility(robot, x) * wallForce(run.scenario, p)));
      },
      goalOf(run).q);
  return balance(run, tipPose(robot, q).p);
}

void expectForceControl(const Trace& run) { expectLaw(run, {"force_pi", "parallel_force_position"}); }

Vector3 desiredForce(const Trace& run) { return run.scenario.trajectory.h_d.head<3>(); }

}  // namespace

// Md x~'' + Kd x~' + Kp x~ = h_e.
Checks impedanceBalance(const Inputs& in) {
  expectLaw(in.run, {"impedance"});
  const Vector3 md = gain<Vector6>(in.run, "md").head<3>(), kd = gain<Vector6>(in.run, "kd").head<3>(),
                kp = gain<Vector6>(in.run, "kp").head<3>();
  Checks checks = yieldingTip(in.run, md, kd, kp, kp.cwiseQuotient(md).minCoeff());
  checks.push_back(
      sampledTip(in.run, [&](const Reference& ref, const Vector3& p, const Vector3& v, const Vector3& h_e) {
        const Vector3 pull = kd.cwiseProduct(ref.V_WE.head<3>() - v) + kp.cwiseProduct(ref.X_WE.p - p) - h_e;
        return Vector3(ref.A_WE.head<3>() + pull.cwiseQuotient(md));
      }));
  return checks;
}

// tau = B y + n - J^T h_e against a wall that takes J^T h_e again: B y = 2 J^T h_e at rest, J y = Md^-1 Kp x~.
Checks printedImpedanceBalance(const Inputs& in) { return throughTheArm(in.run, "as_printed", 2.0); }

// tau = B y + n: B y = J^T h_e at rest.
Checks unforcedImpedanceBalance(const Inputs& in) { return throughTheArm(in.run, "no_force", 1.0); }

// Mt z'' + Kdt z' + Kpt z = h_e, and the inner loop, which starts without an error, is on x_d - z.
Checks admittanceBalance(const Inputs& in) {
  expectLaw(in.run, {"admittance"});
  const Vector3 mt = gain<Vector3>(in.run, "mt"), kdt = gain<Vector3>(in.run, "kdt"),
                kpt = gain<Vector3>(in.run, "kpt"), kp = gain<Vector6>(in.run, "kp").head<3>(),
                kd = gain<Vector6>(in.run, "kd").head<3>();
  Checks checks = yieldingTip(in.run, mt, kdt, kpt, kp.minCoeff());
  Vector3 z = Vector3::Zero(), zd = Vector3::Zero();  // advanced in closed form, h_e held
  checks.push_back(
      sampledTip(in.run, [&](const Reference& ref, const Vector3& p, const Vector3& v, const Vector3& h_e) {
        const Vector3 zdd = (h_e - kdt.cwiseProduct(zd) - kpt.cwiseProduct(z)).cwiseQuotient(mt);
        Vector3 wish = ref.A_WE.head<3>() - zdd + kd.cwiseProduct(ref.V_WE.head<3>() - zd - v) +
                       kp.cwiseProduct(ref.X_WE.p - z - p);
        for (int i = 0; i < 3; ++i) {
          const double rest = h_e(i) / kpt(i);
          const FreeResponse next =
              freeResponse(mt(i), kdt(i), kpt(i), {z(i) - rest, zd(i)}, in.run.scenario.stepSeconds());
          z(i) = rest + next.e;
          zd(i) = next.ed;
        }
        return wish;
      }));
  return checks;
}

// f_e = f_d along the walls' normals, at the depth that takes; x_e = x_F.
Checks forceGoal(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"force_pi"});
  const Eigen::Index k = restStep(run);
  const Vector3 f_d = desiredForce(run);
  const Eigen::MatrixXd x_F = forceReference(run);
  Checks checks;
  for (const PlaneSpec& wall : run.scenario.walls) {
    const Vector3 normal = wall.normal.normalized();
    checks.push_back(atRest("force on the wall", "N", normal.dot(f_d), normal.dot(Vector3(run.h_e.col(k).head<3>()))));
    checks.push_back(atRest("depth in the wall, f_d / Ke", "m", normal.dot(f_d) / wall.stiffness_N_per_m,
                            normal.dot(Vector3(run.p_WE.col(k)) - wall.point_m)));
  }
  for (int i = 0; i < 3; ++i)
    checks.push_back(atRest(std::string("x_F - x_e along ") + kAxes[i], "m", 0.0, x_F(i, k) - run.p_WE(i, k)));
  return checks;
}

// Where nothing pushes back, f_e = 0: w grows at Ki f_d for ever. The tip follows a ramp of that slope as
// Md x'' + Kd x' + Kp x = Kp x_F does, Kd Ki f_d / Kp behind it. Along the walls' normals f_e = f_d all the same.
Checks forceDrift(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"force_pi"});
  const Eigen::Index k = restStep(run), before = k - k / 10;
  const double elapsed = run.time(k) - run.time(before);
  const Vector3 f_d = desiredForce(run), ki = gain<Vector3>(run, "ki"), kd = gain<Vector3>(run, "kd"),
                kp = gain<Vector3>(run, "kp");
  Vector3 held = Vector3::Zero();  // the part of f_d that the walls give, when no two share a direction
  for (const PlaneSpec& wall : run.scenario.walls) {
    const Vector3 normal = wall.normal.normalized();
    held += normal.dot(f_d) * normal;
  }
  const Vector3 speed = ki.cwiseProduct(f_d - held);
  const Eigen::MatrixXd x_F = forceReference(run);
  Checks checks;
  for (int i = 0; i < 3; ++i) {
    checks.push_back(atRest(std::string("speed of the tip along ") + kAxes[i], "m/s", speed(i),
                            (run.p_WE(i, k) - run.p_WE(i, before)) / elapsed));
    checks.push_back(
        atRest(std::string("x_F - x_e along ") + kAxes[i], "m", kd(i) * speed(i) / kp(i), x_F(i, k) - run.p_WE(i, k)));
  }
  for (const PlaneSpec& wall : run.scenario.walls) {
    const Vector3 normal = wall.normal.normalized();
    checks.push_back(atRest("force on the wall", "N", normal.dot(f_d), normal.dot(Vector3(run.h_e.col(k).head<3>()))));
  }
  return checks;
}

// f_e = f_d along the wall's normal and x = x_d across it; the error along it is z_d - z_r - f_d / Ke.
Checks parallelGoal(const Inputs& in) {
  const Trace& run = in.run;
  expectLaw(run, {"parallel_force_position"});
  if (run.scenario.walls.size() != 1) {
    throw UsageError("run " + run.scenario.name + ": expected one wall for this check, found " +
                     std::to_string(run.scenario.walls.size()));
  }
  const PlaneSpec& wall = run.scenario.walls.front();
  const Vector3 normal = wall.normal.normalized(), x_d = goalOf(run).X_WE.p;
  const double depth = normal.dot(desiredForce(run)) / wall.stiffness_N_per_m;
  return balance(run, x_d - (normal.dot(x_d - wall.point_m) - depth) * normal);
}

}  // namespace baton::theory

namespace baton {

Eigen::MatrixXd forceReference(const Trace& trace) {
  theory::expectForceControl(trace);
  const Vector3 kf = theory::gain<Vector3>(trace, "kf"), ki = theory::gain<Vector3>(trace, "ki");
  const bool is_alone = theory::controllerOf(trace).law == "force_pi";
  const double dt_s = trace.scenario.stepSeconds();
  Eigen::MatrixXd x_F(3, trace.steps());
  Vector3 w = Vector3::Zero();
  for (Eigen::Index k = 0; k < trace.steps(); ++k) {
    const Vector3 f_error = theory::desiredForce(trace) - Vector3(trace.h_e.col(k).head<3>());
    if (k == 0 && is_alone) w = Vector3(trace.p_WE.col(0)) - kf.cwiseProduct(f_error);
    x_F.col(k) = kf.cwiseProduct(f_error) + w;
    w += dt_s * ki.cwiseProduct(f_error);
  }
  return x_F;
}

}  // namespace baton
