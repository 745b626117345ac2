#include <memory>
#include <sstream>
#include <stdexcept>

#include "bench/agreement.hpp"
#include "bench/cases.hpp"
#include "bench/kdl_dynamics.hpp"
#include "bench/mujoco_dynamics.hpp"
#include "robot/kinematics.hpp"

namespace baton::bench {
namespace {

template <typename Library>
void addLibrary(const std::string& arm, const std::string& who, const std::shared_ptr<Library>& library) {
  const auto add = [&](const std::string& quantity, auto call) {
    addCase(arm + "/" + quantity + "/" + who, [library, call](int k) { return call(*library, k); });
  };
  add("inverse dynamics", [](Library& it, int k) { return it.inverseDynamics(k); });
  add("mass matrix", [](Library& it, int k) { return it.massMatrix(k); });
  add("forward dynamics", [](Library& it, int k) { return it.forwardDynamics(k); });
  add("gravity", [](Library& it, int k) { return it.gravity(k); });
  add("B, C qd + g, g", [](Library& it, int k) { return it.terms(k); });
}

/// What the others do not offer in one piece: C as a matrix, and all of the tip's kinematics.
void addBatonAlone(const std::string& arm, const RobotModel& model, const std::vector<DynamicState>& states) {
  addCase(arm + "/B, C, g by Lagrange/Baton", [model, states, out = LagrangeTerms{}](int k) mutable {
    lagrangeDynamics(model, states[k].q, states[k].qd, out);
    return out.C.data();
  });
  addCase(arm + "/tip pose, twist, J, J' qd/Baton", [model, states, out = Kinematics{}](int k) mutable {
    computeKinematics(model, states[k].q, states[k].qd, out);
    return out.J.data();
  });
}

void requireAgreement(const std::string& arm, const std::string& who, double apart) {
  if (apart < kAgreement) return;
  std::ostringstream message;
  message << arm << ": Baton and " << who << " differ by " << apart << ", and " << kAgreement
          << " is allowed; there is nothing to compare";
  throw std::runtime_error(message.str());
}

void addArm(const std::string& arm, const RobotModel& model) {
  const std::vector<DynamicState> states = randomStates(model.size(), kStates, 1);
  const auto baton = std::make_shared<BatonDynamics>(model, states);
  const auto kdl = std::make_shared<KdlDynamics>(model, states);
  const auto mujoco = std::make_shared<MujocoDynamics>(model, states);
  requireAgreement(arm, "orocos-kdl", largestDistance(*baton, *kdl, kStates));
  requireAgreement(arm, "MuJoCo", largestDistance(*baton, *mujoco, kStates));

  addLibrary(arm, "Baton", baton);
  addLibrary(arm, "orocos-kdl", kdl);
  addLibrary(arm, "MuJoCo", mujoco);
  addBatonAlone(arm, model, states);
}

}  // namespace

void addDynamics() {
  for (const Arm& arm : arms()) addArm(arm.name, arm.model);
}

}  // namespace baton::bench
