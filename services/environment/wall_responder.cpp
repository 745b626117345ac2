#include "wall_responder.hpp"

#include <algorithm>

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
  Contact total;
  for (const PlaneSpec& wall : service_.scenario().walls) {
    const Contact one = planeContact(wall, state_.X_WE.p, v_WE);
    total.h_e += one.h_e;
    total.df_dp += one.df_dp;
    total.df_dv += one.df_dv;
    total.penetration = std::max(total.penetration, one.penetration);
  }
  toMessage({message.step(), message.time_ns()}, total, message_);
  contact_out_.write(message_);
  service_.at(message.step());
  service_.stepDone(message.step());
}

}  // namespace baton
