/// Force control with an inner position loop and a PI force loop around it:
///   tau = B(q) y + n(q, qd) + J^T h_e,   y = J_P^-1 Md^-1 (-Kd x' + Kp (x_F - x) - Md Jdot_P qd),
///   x_F = Kf (f_d - f_e) + w,   w' = Ki (f_d - f_e),   f_e the force the tip exerts on the environment.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 9.4.1.
/// Assumes contact with an elastic environment: at rest f_e = f_d and x_e = x_F. In a direction where nothing pushes
/// back the tip drifts at Ki (f_d - f_e). Orientation is not controlled.
/// The report prints J^T f_e with a force for a six-row J (the wrench is meant) and does not say where the integral
/// starts; here a new run starts with x_F(0) = x_e(0), so that it does not begin with a leap. It calls f_d = (0, 0, 6)
/// out of the image of Ke and sees drag in it; with Ke = diag(0, 0, Ke) it is inside, and the force converges.
/// Handover and anti-windup of w: control/force_control.hpp.
#include "control/force_control.hpp"

namespace baton::laws {

LawInfo forcePi() {
  return {.name = "force_pi",
          .summary = "force control: PI on the contact force around a position loop",
          .uses_force = true,
          .requires_contact = true,
          .parameters = forceControlParameters(),
          .make = [](const RobotModel& model, const ParameterValues& values) {
            return makeForceControl(ForceLoop::kAlone, model, values);
          }};
}

}  // namespace baton::laws
