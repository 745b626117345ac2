/// What a scenario lets go wrong.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "dds/topics.hpp"
#include "runtime/scenario.hpp"
#include "runtime/scenario_parts.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxFaults = 1000;
const NumberRange kSeconds{0.0, 3600.0, "s of real time", true};
const NumberRange kBiasNumber{-1e9, 1e9, "of what the topic says"};

/// Who can be at fault, and on which topics it answers a step.
std::vector<std::string> topicsOf(const std::string& service) {
  if (service == kPlantName) return {dds::topics::kPlantState.name};
  if (service == kEnvironmentName) return {dds::topics::kContact.name};
  if (service == kTrajectoryName) return {dds::topics::kReference.name};
  if (service == kRecorderName) return {};
  return {dds::topics::kJointCommand.name, dds::topics::kShadowCommand.name};
}

void readMessageFault(const YamlMap& map, const Scenario& scenario, Fault& fault) {
  const std::vector<std::string> topics = topicsOf(fault.service);
  const YamlNode topic = map["topic"];
  fault.topic = topic.text(64);
  if (std::find(topics.begin(), topics.end(), fault.topic) == topics.end()) {
    topic.refuse(topics.empty() ? "no topic: the recorder answers no steps"
                                : fmt::format("a topic of {}: {}", fault.service, fmt::join(topics, " or ")));
  }
  if (fault.service == kPlantName && !isOfValues(fault.kind)) {
    map["do"].refuse(
        "nan, stuck or bias: everybody waits for the plant's word, so it is what others answer that can be lost");
  }
  if (const auto until = map.find("until_s")) {
    fault.until_step = readSteps(*until, scenario);
    if (fault.until_step <= fault.from_step) until->refuse("a time after at_s");
  }
  fault.probability = map.numberOr("probability", {0.0, 1.0, ""}, 1.0);
  fault.seed = static_cast<std::uint64_t>(map.integerOr("seed", 0, 1'000'000'000, 0));
  if (fault.kind == FaultKind::kBias) {
    const YamlNode by = map["by"];
    if (by.isList()) {
      const std::size_t size =
          fault.topic == dds::topics::kContact.name ? 3 : static_cast<std::size_t>(scenario.robot.size());
      fault.by = by.numbers(size, kBiasNumber);
    } else {
      fault.by = {by.number(kBiasNumber)};
    }
  } else if (fault.kind == FaultKind::kDelay) {
    fault.seconds = map["for_s"].number(kSeconds);
  }
}

Fault readFault(const YamlNode& node, const Scenario& scenario) {
  const YamlMap map = node.map({"do", "service", "topic", "at_s", "until_s", "probability", "seed", "by", "for_s"});
  Fault fault;
  std::vector<std::pair<std::string, FaultKind>> kinds;
  for (int i = 0; i <= static_cast<int>(FaultKind::kKill); ++i) {
    kinds.emplace_back(toString(static_cast<FaultKind>(i)), static_cast<FaultKind>(i));
  }
  fault.kind = map["do"].oneOf<FaultKind>(kinds);
  std::vector<std::pair<std::string, std::string>> services;
  for (const std::string& name : serviceNames(scenario)) services.emplace_back(name, name);
  fault.service = map["service"].oneOf<std::string>(services);
  const YamlNode at_s = map["at_s"];
  fault.from_step = readSteps(at_s, scenario);
  if (fault.from_step == 0) at_s.refuse("a time after the first step");
  fault.until_step = fault.from_step + 1;
  if (!isOfProcess(fault.kind)) {
    readMessageFault(map, scenario, fault);
  } else if (fault.kind == FaultKind::kStop) {
    if (const auto seconds = map.find("for_s")) fault.seconds = seconds->number(kSeconds);
  }
  const auto refuseUnused = [&](const char* key, bool is_used) {
    if (const auto unused = map.find(key); unused && !is_used) {
      unused->refuse("no " + std::string(key) + " with do: " + toString(fault.kind));
    }
  };
  const bool is_of_message = !isOfProcess(fault.kind);
  for (const char* key : {"topic", "until_s", "probability", "seed"}) refuseUnused(key, is_of_message);
  refuseUnused("by", fault.kind == FaultKind::kBias);
  refuseUnused("for_s", fault.kind == FaultKind::kDelay || fault.kind == FaultKind::kStop);
  return fault;
}

}  // namespace

void readFaults(const YamlMap& map, Scenario& scenario) {
  const auto node = map.find("faults");
  if (!node) return;
  for (const YamlNode& item : node->list(0, kMaxFaults)) scenario.faults.push_back(readFault(item, scenario));
}

}  // namespace baton
