#include "runtime/admission.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "runtime/processes.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

/// The service whose topic it is; empty where several may write.
const char* soleWriter(dds::WrittenBy who) {
  switch (who) {
    case dds::WrittenBy::kPlant: return kPlantName;
    case dds::WrittenBy::kEnvironment: return kEnvironmentName;
    case dds::WrittenBy::kTrajectory: return kTrajectoryName;
    default: return "";
  }
}

std::string claimOf(const dds::Participant& participant, const dds::GuidPrefix& stranger) {
  const auto claim = participant.stranger(stranger);
  return claim ? " and calls itself " + claim->service : "";
}

std::string hasNoKey(const dds::GuidPrefix& stranger) {
  return ": participant " + dds::toString(stranger) + " has not the run's key and is not heard";
}

/// Baton's, of which it has writers, as far as discovery has told: "contact, reference".
std::string topicsOf(const dds::Participant& participant, const dds::GuidPrefix& stranger) {
  std::set<std::string> topics;
  for (const dds::DiscoveredWriter& writer : participant.writers()) {
    if (dds::prefixOf(writer.guid) == stranger && dds::topics::called(writer.topic)) topics.insert(writer.topic);
  }
  return fmt::format("{}", fmt::join(topics, ", "));
}

}  // namespace

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
  const auto role = participant_.roleOf(prefix);
  if (!role) {
    tellOnce(Deed::kSpeaks, prefix, [&] {
      const std::string text = "a stranger writes on " + std::string(topic.name);
      const auto departed = participant_.departed(prefix);
      if (!departed) return text + claimOf(participant_, prefix) + hasNoKey(prefix);
      return text + " under the GUID of " + departed->service + ": participant " + dds::toString(prefix) +
             " has left, or its process cannot be seen from here, and is not heard";
    });
    return false;
  }
  const auto peer = participant_.peer(prefix);
  // Nobody watches commands, and one may have been killed.
  if (role == dds::Role::kOperator && peer && !isRunning(*peer)) {
    tellOnce(Deed::kSpeaks, prefix,
             [&] { return peer->service + " asks for something on " + topic.name + ", but its process has ended"; });
    return false;
  }
  if (mayWrite(topic.written_by, *role)) return true;
  tellOnce(Deed::kSpeaks, prefix, [&] {
    return (peer ? peer->service : dds::toString(prefix)) + " writes on " + topic.name +
           ", which is not its topic, and is not heard there";
  });
  return false;
}

dds::WriterFilter Admission::filter(const dds::TopicFacts& topic) {
  if (topic.written_by == dds::WrittenBy::kOperators) {
    return [this, topic](const dds::Guid& writer) { return admits(topic, writer); };
  }
  return [this, topic, known = std::set<dds::Guid>(), departures = std::uint64_t{0}](const dds::Guid& writer) mutable {
    if (const std::uint64_t now = participant_.departures(); std::exchange(departures, now) != now) known.clear();
    if (known.contains(writer)) return true;
    if (!admits(topic, writer)) return false;
    known.insert(writer);
    return true;
  };
}

bool Admission::speaksFor(const dds::Guid& writer, std::string_view service) const {
  const dds::GuidPrefix prefix = dds::prefixOf(writer);
  if (!participant_.hasKey() || participant_.roleOf(prefix) == dds::Role::kSupervisor) return true;
  if (!participant_.isMember(prefix)) return false;
  const auto peer = participant_.peer(prefix);
  return !peer || peer->service == service;  // its name may still be on its way
}

void Admission::met(const dds::Peer& stranger) {
  tellOnce(Deed::kIsThere, stranger.prefix, [&] {
    return "a stranger" +
           (stranger.service.empty() ? " bears the mark of this run and does not say who it is"
                                     : " calls itself " + stranger.service + " of run " + stranger.run) +
           hasNoKey(stranger.prefix);
  });
}

void Admission::turnedAway(const dds::GuidPrefix& stranger, dds::Trespass what) {
  if (what == dds::Trespass::kAsksTooMuch) {
    return tellOnce(Deed::kAsks, stranger, [&] {
      return "a stranger" + claimOf(participant_, stranger) + " asks for samples again and again: participant " +
             dds::toString(stranger) + " and others without the run's key are sent no more than " +
             std::to_string(dds::Gate::kAsksPerSecond) + " a second";
    });
  }
  tellOnce(Deed::kSpeaks, stranger, [&] {
    const std::string topics = topicsOf(participant_, stranger);
    return "a stranger writes" + (topics.empty() ? "" : " on " + topics) + claimOf(participant_, stranger) +
           hasNoKey(stranger);
  });
}

void Admission::tellOnce(Deed deed, const dds::GuidPrefix& prefix, const std::function<std::string()>& text) {
  bool is_last = false;
  {
    const std::lock_guard lock(mutex_);
    std::set<dds::GuidPrefix>& told = told_[deed];
    if (told.size() >= kMaxStrangersTold || !told.insert(prefix).second) return;
    is_last = told.size() == kMaxStrangersTold;
  }
  tell_(text() + (is_last ? "; who does the same from now on is not named" : ""));
}

}  // namespace baton
