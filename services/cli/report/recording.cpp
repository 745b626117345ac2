#include "recording.hpp"

#include <charconv>

#include "base/error.hpp"
#include "mcap/lookup.hpp"

namespace baton {
namespace {

[[noreturn]] void missTopic(const std::string& topic, const mcap::FileList& file) {
  throw UsageError(file.string() + ": expected the topic " + topic + ", found a recording without it: the scenario's " +
                   "recording.topics and recording.except, or `bag cut --topics`, have to let it through");
}

}  // namespace

std::string neededAttachment(const mcap::Source& reader, const std::string& name, const mcap::FileList& file) {
  if (auto text = attachmentText(reader, name)) return *text;
  throw UsageError(file.string() + ": expected the recording of a run, with its " + name + ", found none");
}

Scenario recordedScenario(const mcap::Source& reader, const mcap::FileList& file) {
  const std::string robot_text = neededAttachment(reader, "robot.yaml", file);
  return parseScenario(file.string() + "#scenario.yaml", neededAttachment(reader, "scenario.yaml", file),
                       file.string() + "#robot.yaml", robot_text);
}

void expectTopic(const mcap::Source& reader, const std::string& topic, const mcap::FileList& file) {
  expectNotLeftOut(reader, topic, file);
  if (!hasTopic(reader, topic)) {
    throw UsageError(file.string() + ": expected the recording of a run, with messages of " + topic + ", found none");
  }
}

void expectNotLeftOut(const mcap::Source& reader, const std::string& topic, const mcap::FileList& file) {
  if (!hasTopic(reader, topic) && isLeftOut(reader, topic)) missTopic(topic, file);
}

bool isCertified(const mcap::Source& reader) {
  return metadataValue(reader, "baton.certificate", "complete") == "true";
}

std::optional<unsigned> partIndex(const mcap::Source& reader) {
  const std::string text = metadataValue(reader, "baton.part", "index");
  unsigned index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return index;
}

}  // namespace baton
