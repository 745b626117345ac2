#include "runtime/admission.hpp"

#include <algorithm>
#include <array>

#include "runtime/service_options.hpp"

namespace baton {
namespace {

bool isOperator(std::string_view service) { return service.starts_with(kOperatorPrefix); }

bool isController(std::string_view service) {
  constexpr std::array<std::string_view, 5> kOthers{kPlantName, kEnvironmentName, kTrajectoryName, kRecorderName,
                                                    kSupervisorName};
  return !isOperator(service) && std::ranges::find(kOthers, service) == kOthers.end();
}

/// The service whose topic it is; empty where several may write.
const char* soleWriter(dds::WrittenBy who) {
  switch (who) {
    case dds::WrittenBy::kPlant: return kPlantName;
    case dds::WrittenBy::kEnvironment: return kEnvironmentName;
    case dds::WrittenBy::kTrajectory: return kTrajectoryName;
    default: return "";
  }
}

}  // namespace

bool mayWrite(dds::WrittenBy who, std::string_view service) {
  if (service == kSupervisorName) return true;
  switch (who) {
    case dds::WrittenBy::kPlant: return service == kPlantName;
    case dds::WrittenBy::kEnvironment: return service == kEnvironmentName;
    case dds::WrittenBy::kTrajectory: return service == kTrajectoryName;
    case dds::WrittenBy::kControllers: return isController(service);
    case dds::WrittenBy::kServices: return !isOperator(service);
    case dds::WrittenBy::kOperators: return true;
  }
  return false;
}

bool yieldsTo(const dds::Peer& self, const dds::Peer& other, bool is_believed, bool has_begun) {
  const bool is_namesake = other.cell == self.cell && other.service == self.service;
  if (!is_believed || !is_namesake || !isElder(other, self)) return false;
  return other.run == self.run || (self.service == kPlantName && !has_begun);
}

std::string badInputText(std::string_view topic, std::uint64_t step, std::string_view why) {
  const dds::TopicFacts* facts = dds::topics::called(topic);
  const std::string writer = facts == nullptr ? "" : soleWriter(facts->written_by);
  return writer.empty() ? writer
                        : writer + " sent " + facts->name + " of step " + std::to_string(step) +
                              ", which cannot be used: its " + std::string(why);
}

bool Admission::admits(const dds::TopicFacts& topic, const dds::Guid& writer) {
  const dds::GuidPrefix prefix = dds::prefixOf(writer);
  if (is_open_ && topic.written_by == dds::WrittenBy::kOperators) return true;
  if (!participant_.hasKey()) return true;
  if (!participant_.isMember(prefix)) {
    const auto claim = participant_.stranger(prefix);
    tellOnce(prefix, "a stranger writes on " + std::string(topic.name) +
                         (claim ? " and calls itself " + claim->service : "") + ": participant " +
                         dds::toString(prefix) + " has not the run's key and is not heard");
    return false;
  }
  const auto peer = participant_.peer(prefix);
  // It has the key; its name may still be on its way.
  if (!peer || mayWrite(topic.written_by, peer->service)) return true;
  tellOnce(prefix, peer->service + " writes on " + topic.name + ", which is not its topic, and is not heard there");
  return false;
}

void Admission::met(const dds::Peer& stranger) {
  tellOnce(stranger.prefix, "a stranger calls itself " + stranger.service + " of run " + stranger.run +
                                ": participant " + dds::toString(stranger.prefix) +
                                " has not the run's key and is not heard");
}

void Admission::tellOnce(const dds::GuidPrefix& prefix, const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    if (told_.size() >= kMaxStrangersTold || !told_.insert(prefix).second) return;
  }
  tell_(text);
}

}  // namespace baton
