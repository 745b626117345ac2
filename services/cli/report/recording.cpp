#include "recording.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_messages.hpp"

namespace baton {
namespace {

/// By the certificate, or by a copy that took only some topics of one that had it.
bool isLeftOut(const mcap::Reader& reader, const std::string& topic) {
  auto text = attachmentText(reader, "certificate.json");
  if (!text) text = attachmentText(reader, "original_certificate.json");
  const nlohmann::json certificate = nlohmann::json::parse(text.value_or(""), nullptr, false);
  const auto listOf = [&](const char* key) {
    const auto list = certificate.is_object() ? certificate.find(key) : certificate.end();
    return list != certificate.end() && list->is_array() ? *list : nlohmann::json::array();
  };
  const nlohmann::json left_out = listOf("left_out"), streams = listOf("streams");
  if (std::count(left_out.begin(), left_out.end(), nlohmann::json(topic)) > 0) return true;
  if (metadataValue(reader, "baton.cut", "topics").empty()) return false;
  return std::any_of(streams.begin(), streams.end(), [&](const nlohmann::json& row) {
    return row.is_object() && row.value("topic", nlohmann::json()) == topic &&
           row.value("count", nlohmann::json()) != nlohmann::json(0);
  });
}

/// For a recording without the topic that announces a reset: a take begins where the steps go back.
Take lastTakeByStates(const mcap::Reader& reader) {
  Take last;
  std::map<mcap::ChannelId, std::uint64_t> steps;
  forEachMessageOf(dds::topics::kPlantState, reader, 0, [&](const msg::PlantState& state, const auto& view) {
    const auto [step, is_first] = steps.try_emplace(view.channel->id, state.step());
    if (!is_first && state.step() < step->second) last = {.number = last.number + 1, .begin_ns = view.log_time_ns};
    step->second = state.step();
  });
  return last;
}

[[noreturn]] void missTopic(const std::string& topic, const std::filesystem::path& file) {
  throw UsageError(file.string() + ": expected the topic " + topic + ", found a recording without it: the scenario's " +
                   "recording.topics and recording.except, or `bag cut --topics`, have to let it through");
}

}  // namespace

std::optional<std::string> attachmentText(const mcap::Reader& reader, const std::string& name) {
  for (const mcap::AttachmentIndex& index : reader.attachments()) {
    if (index.name != name) continue;
    const mcap::Bytes data = reader.readAttachment(index);
    return std::string(reinterpret_cast<const char*>(data.data()), data.size());
  }
  return std::nullopt;
}

std::string neededAttachment(const mcap::Reader& reader, const std::string& name, const std::filesystem::path& file) {
  if (auto text = attachmentText(reader, name)) return *text;
  throw UsageError(file.string() + ": expected the recording of a run, with its " + name + ", found none");
}

Scenario recordedScenario(const mcap::Reader& reader, const std::filesystem::path& file) {
  const std::string robot_text = neededAttachment(reader, "robot.yaml", file);
  return parseScenario(file.string() + "#scenario.yaml", neededAttachment(reader, "scenario.yaml", file),
                       file.string() + "#robot.yaml", robot_text);
}

bool hasTopic(const mcap::Reader& reader, const std::string& topic) {
  const auto& counts = reader.statistics().channel_message_counts;
  return std::ranges::any_of(reader.channels(), [&](const auto& entry) {
    const auto count = counts.find(entry.first);
    return entry.second.topic == topic && count != counts.end() && count->second > 0;
  });
}

void expectTopic(const mcap::Reader& reader, const std::string& topic, const std::filesystem::path& file) {
  expectNotLeftOut(reader, topic, file);
  if (!hasTopic(reader, topic)) {
    throw UsageError(file.string() + ": expected the recording of a run, with messages of " + topic + ", found none");
  }
}

void expectNotLeftOut(const mcap::Reader& reader, const std::string& topic, const std::filesystem::path& file) {
  if (!hasTopic(reader, topic) && isLeftOut(reader, topic)) missTopic(topic, file);
}

mcap::StringMap metadataOf(const mcap::Reader& reader, const std::string& record) {
  mcap::StringMap values;
  for (const mcap::Metadata& one : reader.metadata()) {
    if (one.name == record) values.insert(one.values.begin(), one.values.end());
  }
  return values;
}

std::string metadataValue(const mcap::Reader& reader, const std::string& record, const std::string& key) {
  return mcap::valueOf(metadataOf(reader, record), key);
}

bool isCertified(const mcap::Reader& reader) {
  return metadataValue(reader, "baton.certificate", "complete") == "true";
}

std::optional<unsigned> partIndex(const mcap::Reader& reader) {
  const std::string text = metadataValue(reader, "baton.part", "index");
  unsigned index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

std::uint64_t lastTakeBegin(const mcap::Reader& reader) { return lastTake(reader).begin_ns; }

Take lastTake(const mcap::Reader& reader) {
  const char* topic = dds::topics::kRewind.name;
  if (!hasTopic(reader, topic) && isLeftOut(reader, topic)) return lastTakeByStates(reader);
  Take last;
  forEachMessageOf(dds::topics::kRewind, reader, 0, [&](const msg::Rewind& rewind, const auto& view) {
    if (rewind.phase() != msg::REWIND_COMMIT || view.log_time_ns < last.begin_ns) return;
    last = {.number = rewind.take(), .begin_ns = view.log_time_ns};
  });
  return last;
}

}  // namespace baton
