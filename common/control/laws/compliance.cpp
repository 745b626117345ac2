/// Compliance control: operational-space PD with gravity compensation, softer, against an environment:
///   tau = g(q) + J_A^T (Kp x~ - Kd J_A qd),  x~ = x_d - x.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 9.2.
/// Assumes a set-point; it measures no force. At rest J_A^T Kp x~ = J^T h_e: Kp^-1 is the compliance with which the tip
/// gives way, and out of contact x = x_d.
/// The report prints tau - J^T h_e as the law's total. The environment subtracts J^T h_e, not the law. It sees a small
/// error in y and blames one link's pull on another; there is none, as y is q2's alone and the wall pushes along z.
#include "control/tip_pd.hpp"

namespace baton::laws {

LawInfo compliance() {
  return {.name = "compliance",
          .summary = "compliance control: a soft operational-space PD, for contact without a force sensor",
          .parameters = tipPdParameters({550.0, 550.0, 550.0, 30.0, 30.0, 30.0},  //
                                        {70.0, 70.0, 70.0, 10.0, 10.0, 10.0}),
          .make = makeTipPd};
}

}  // namespace baton::laws
