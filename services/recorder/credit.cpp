#include "credit.hpp"

#include "dds/topics.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

/// The step a payload of the loop belongs to: its first member, behind the encapsulation header.
std::uint64_t stepOf(std::span<const std::byte> payload) {
  std::uint64_t step = 0;
  if (payload.size() < 12) return 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const bool little_endian = (payload[1] & std::byte{1}) != std::byte{0};
    const std::size_t at = 4 + (little_endian ? 7 - i : i);
    step = (step << 8) | std::to_integer<std::uint64_t>(payload[at]);
  }
  return step;
}

}  // namespace

StepCredit::StepCredit(const Scenario& scenario)
    : every_(std::max<std::uint64_t>(1, scenario.recording.credit_steps / 8)) {
  // Not the commands: while the brake holds there are none. A writer remembers more steps than the credit, so they are
  // safe.
  steps_ = {{.topic = dds::topics::kPlantState.name}, {.topic = dds::topics::kReference.name}};
  if (scenario.hasEnvironment()) steps_.push_back({.topic = dds::topics::kContact.name});
}

std::optional<std::size_t> StepCredit::placeOf(const std::string& topic) const {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (steps_[i].topic == topic) return i;
  }
  return std::nullopt;
}

void StepCredit::came(std::size_t place, std::span<const std::byte> payload) {
  Awaited& awaited = steps_[place];
  const std::uint64_t step = stepOf(payload);
  if (place == 0 && awaited.has_come && step > awaited.latest) elapsed_ += step - awaited.latest;
  awaited.latest = awaited.has_come ? std::max(awaited.latest, step) : step;
  awaited.has_come = true;
}

void StepCredit::rewound(const msg::Rewind& rewind) {
  owed_.reset();
  if (rewind.phase() == msg::REWIND_CANCEL) return;
  if (rewind.phase() == msg::REWIND_COMMIT) {
    take_ = rewind.take();
    for (Awaited& awaited : steps_) {
      awaited.latest = 0;
      awaited.has_come = false;
    }
    told_ = 0;
  }
  owed_ = rewind;
}

std::uint64_t StepCredit::acknowledged() const {
  return std::min_element(steps_.begin(), steps_.end(),
                          [](const Awaited& a, const Awaited& b) { return a.latest < b.latest; })
      ->latest;
}

bool StepCredit::isDue(bool is_idle) const {
  const std::uint64_t here = acknowledged();
  return here >= told_ + every_ || (is_idle && here != told_);
}

/// Everything up to the open step is here, or a new take has begun: the plant waits to hear so.
std::optional<msg::RewindAck> StepCredit::answer() {
  if (!owed_ || (owed_->phase() == msg::REWIND_PREPARE && acknowledged() < owed_->at_step())) return std::nullopt;
  msg::RewindAck ack;
  ack.take(owed_->take());
  ack.phase(owed_->phase());
  ack.name(kRecorderName);
  owed_.reset();
  return ack;
}

}  // namespace baton
