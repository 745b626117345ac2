#include "wall_responder.hpp"

#include "control/law.hpp"

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
    : service_(service),
      contact_out_(service, dds::topics::kContact, readersOf(service.scenario())),
      answer_(service.scenario()) {
  service.input(dds::topics::kPlantState, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample&) { onState(message); });
  service.input(dds::topics::kPlantStateAgain, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample&) {
                  if (!answered_ || *answered_ < message.step()) onState(message);
                });
  service.onRewind([this](std::uint64_t step) { return answered_ && *answered_ >= step; },
                   [this] { answered_.reset(); });
}

void WallResponder::onState(const msg::PlantState& message) {
  if (!service_.isReady() || service_.isOver()) return;
  if (const Reading reading = answer_(message, message_); !reading) {
    return service_.refuse(dds::topics::kPlantState, message.step(), reading);
  }
  service_.at(message.step());
  contact_out_.write(message_);
  answered_ = message.step();
  service_.stepDone(message.step());
}

}  // namespace baton
