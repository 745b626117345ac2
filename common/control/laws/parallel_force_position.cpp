/// Parallel force/position control: force control whose force loop shifts a desired position instead of replacing it:
///   tau = B(q) y + n(q, qd) + J^T h_e,   y = J_P^-1 Md^-1 (-Kd x' + Kp (x_d + x_F - x) - Md Jdot_P qd),
///   x_F = Kf (f_d - f_e) + w,   w' = Ki (f_d - f_e),   f_e the force the tip exerts on the environment.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 9.4.3.
/// Assumes an elastic environment and f_d along the directions in which it pushes back: there the integral makes force
/// win, f_e = f_d, and x~ is whatever that takes (z_d - z_r - f_d / Ke against the report's wall); in the others f_e =
/// f_d = 0 and x = x_d at rest. Velocity and acceleration of x_d are not fed forward. Orientation is not controlled.
/// The law is fit to receive the baton out of contact: it then follows x_d, and w carries the tip towards the wall.
/// The report's equation needs no correction. It leaves open where the integral starts; here a new run has w(0) = 0.
/// Handover and anti-windup of w: control/force_control.hpp.
#include "control/force_control.hpp"

namespace baton::laws {

LawInfo parallelForcePosition() {
  return {.name = "parallel_force_position",
          .summary = "parallel force/position control: force where the wall pushes back, position elsewhere",
          .uses_force = true,
          .parameters = forceControlParameters(),
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return makeForceControl(ForceLoop::kAroundPosition, model, values);
          }};
}

}  // namespace baton::laws
