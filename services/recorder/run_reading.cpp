#include "run_reading.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <atomic>
#include <memory>

#include "base/text.hpp"

namespace baton {
namespace {

/// A writer's partition may be a pattern, as DDS has it.
bool isOfCell(const dds::DiscoveredWriter& writer, const std::string& partition) {
  return std::any_of(writer.partitions.begin(), writer.partitions.end(),
                     [&](const std::string& theirs) { return fnmatch(theirs.c_str(), partition.c_str(), 0) == 0; });
}

/// @param told  how many writers have been told of.
bool isAdmitted(Service& service, const dds::DiscoveredWriter& writer, std::atomic<std::size_t>& told) {
  if (!isPlain(writer.topic) || !isPlain(writer.type)) {
    if (told++ < kMaxStrangersTold) {
      service.event(
          msg::SEVERITY_WARNING, "stranger",
          "a writer of " + dds::toString(writer.guid) +
              " is not recorded: control characters in the name of its topic or type, or bytes that are not UTF-8");
    }
    return false;
  }
  const dds::TopicFacts* facts = dds::topics::called(writer.topic);
  return facts == nullptr || service.admission().admits(*facts, writer.guid);
}

/// Of each topic, the services whose samples count from the first one on; none for a topic that the run does not await.
std::vector<std::string> awaitedFrom(const dds::TopicFacts& topic, const Scenario& scenario) {
  switch (topic.recorded_from) {
    case dds::RecordedFrom::kNobody: break;
    case dds::RecordedFrom::kPlant: return {kPlantName};
    case dds::RecordedFrom::kTrajectory: return {kTrajectoryName};
    case dds::RecordedFrom::kEnvironment:
      return scenario.hasEnvironment() ? std::vector<std::string>{kEnvironmentName} : std::vector<std::string>{};
    case dds::RecordedFrom::kControllers: return controllerNames(scenario);
    case dds::RecordedFrom::kServices: return servicesBut(kRecorderName, scenario);
  }
  return {};
}

/// A guest in its own run, without the key and of no name in the cell: it hears everybody.
dds::ParticipantOptions guestOf(const ServiceOptions& options) {
  const dds::ParticipantOptions member = options.participant();
  return {.domain = member.domain,
          .partition = member.partition,
          .cell = "",
          .other_cells = {member.cell},
          .run = "",
          .service = "recorder-of-foreign-topics",
          .transport = member.transport,
          .clock = member.clock};
}

}  // namespace

ReadingRules rulesOfRun(Service& service) {
  constexpr std::size_t kMaxForeignWriters = 1000;
  const Scenario& scenario = service.scenario();
  ReadingRules rules;
  rules.max_foreign_writers = kMaxForeignWriters;
  rules.another = [&service] { return std::make_unique<dds::Participant>(guestOf(service.options())); };
  rules.max_participants = 2;
  rules.keeps_foreign_apart = true;
  rules.selection = {scenario.recording.topics, scenario.recording.except, scenario.recording.takes_foreign};
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    if (!awaitedFrom(topic, scenario).empty()) rules.awaited.insert(topic.name);
  }
  // No writer waits for the recorder to read these; the recorder itself needs what they say.
  for (const char* name :
       {dds::topics::kServiceStatus.name, dds::topics::kParameterStatus.name, dds::topics::kParameterReply.name}) {
    rules.awaited.insert(name);
  }
  rules.is_wanted = [&service, partition = service.options().participant().partition,
                     told = std::make_shared<std::atomic<std::size_t>>(0)](const dds::DiscoveredWriter& writer) {
    return isOfCell(writer, partition) && isAdmitted(service, writer, *told);
  };
  rules.filter_for = [&service](const std::string& topic) {
    const dds::TopicFacts* facts = dds::topics::called(topic);
    return facts == nullptr ? dds::WriterFilter{} : service.admission().filter(*facts);
  };
  rules.on_match = [&service] { service.matchesChanged(); };
  rules.on_unreadable = [&service, told = std::size_t{0}](const std::string& text) mutable {
    if (told++ < kMaxStrangersTold) service.event(msg::SEVERITY_ERROR, "record", text);
  };
  return rules;
}

void requireRecorded(Service& service, const TopicReaders& readers) {
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    std::vector<std::string> writers = awaitedFrom(topic, service.scenario());
    if (writers.empty()) continue;
    service.require(
        topic.name, [&readers, name = std::string(topic.name)] { return readers.matched(name); }, std::move(writers));
  }
}

}  // namespace baton
