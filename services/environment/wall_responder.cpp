#include "wall_responder.hpp"

#include "control/law.hpp"
#include "environment/plane.hpp"

namespace baton {
namespace {

std::vector<std::string> readersOf(const Scenario& scenario) {
  std::vector<std::string> names{kPlantName};
  for (const ControllerConfig& controller : scenario.controllers) {
    if (findLaw(controller.law).uses_force) names.push_back(controller.name);
  }
  return withRecorder(std::move(names), scenario);
}

}  // namespace

WallResponder::WallResponder(Service& service)
    : service_(service), contact_out_(service.output(dds::topics::kContact, readersOf(service.scenario()))) {
  service.input(dds::topics::kPlantState, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample&) { onState(message); });
}

void WallResponder::onState(const msg::PlantState& message) {
  if (!service_.isReady() || service_.isOver() || !fromMessage(message, service_.scenario().robot.size(), state_))
    return;
  const Vector3 v_WE = state_.V_WE.head<3>();
  const Contact total = planesContact(service_.scenario().walls, state_.X_WE.p, v_WE);
  toMessage({message.step(), message.time_ns()}, total, message_);
  contact_out_.write(message_);
  service_.at(message.step());
  service_.stepDone(message.step());
}

}  // namespace baton
