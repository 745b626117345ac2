#include "bench/kdl_dynamics.hpp"

#include "support/kdl_chain.hpp"

namespace baton::bench {

using test::toKdl;

KdlDynamics::KdlDynamics(const RobotModel& model, const std::vector<DynamicState>& states)
    : chain_(toKdl(model)),
      no_wrenches_(chain_.getNrOfSegments(), KDL::Wrench::Zero()),
      newton_euler_(chain_, toKdl(model.gravity_W)),
      forward_(chain_, toKdl(model.gravity_W)),
      parameters_(chain_, toKdl(model.gravity_W)),
      vector_(chain_.getNrOfJoints()),
      g_(chain_.getNrOfJoints()),
      B_(model.size()) {
  for (const DynamicState& state : states) {
    states_.push_back({toKdl(state.q), toKdl(state.qd), toKdl(state.qdd), toKdl(state.tau)});
  }
}

}  // namespace baton::bench
