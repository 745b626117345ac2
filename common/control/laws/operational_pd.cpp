/// Operational-space PD with gravity compensation: tau = g(q) + J_A^T (Kp x~ - Kd J_A qd),  x~ = x_d - x.
///
/// Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), sec. 8.6.1.
/// Assumes a set-point: the desired velocity is zero, and damping acts on the tip's own. At rest without gravity
/// compensation J_A^T Kp x~ = g(q). Every point where J_A^T Kp x~ = 0 is an equilibrium, whether or not x~ = 0.
/// The report prints (J_A)^T Kp x~ - Kd qd: six damping gains on three joints. J_A^T Kd J_A is meant. It calls the jump
/// of its orientation unidentified and suspects the Jacobian; it is the jump of the ZYZ angles at q1 = pi/2, where
/// det J_P = L is as good as anywhere. What the law does there, and `orientation: rotation_vector`, which has no such
/// place, are in control/tip_pd.hpp.
#include "control/tip_pd.hpp"

namespace baton::laws {

LawInfo operationalPd() {
  return {.name = "operational_pd",
          .summary = "operational-space PD with gravity compensation, for set-points of the tip",
          .parameters = tipPdParameters({200.0, 200.0, 200.0, 50.0, 50.0, 50.0},  //
                                        {150.0, 150.0, 150.0, 20.0, 20.0, 20.0}),
          .make = makeTipPd};
}

}  // namespace baton::laws
