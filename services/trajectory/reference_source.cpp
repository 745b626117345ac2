#include "reference_source.hpp"

namespace baton {
ReferenceSource::ReferenceSource(Service& service)
    : service_(service),
      answer_(service.scenario()),
      reference_out_(service, dds::topics::kReference,
                     withRecorder(controllerNames(service.scenario()), service.scenario())) {
  prepare(message_);
  service.input(dds::topics::kPlantState, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample&) { onState(message); });
  service.input(dds::topics::kPlantStateAgain, {kPlantName},
                [this](const msg::PlantState& message, const dds::RawSample&) {
                  if (!answered_ || *answered_ < message.step()) onState(message);
                });
  service.onRewind([this](std::uint64_t step) { return answered_ && *answered_ >= step; },
                   [this] { answered_.reset(); });
}

void ReferenceSource::onState(const msg::PlantState& message) {
  if (!service_.isReady() || service_.isOver()) return;
  service_.at(message.step());
  if (!answered_) publish(message.step());
  answered_ = message.step();
  publish(message.step() + 1);
  service_.stepDone(message.step());
}

void ReferenceSource::publish(std::uint64_t step) {
  answer_(step, message_);
  reference_out_.write(message_);
}

}  // namespace baton
