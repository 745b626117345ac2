#include "bag/subcommands.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bag/log_times.hpp"
#include "bag/sequence_gaps.hpp"
#include "bag/verdict.hpp"
#include "base/error.hpp"
#include "base/plural.hpp"
#include "base/text.hpp"
#include "dds/types.hpp"
#include "mcap/lookup.hpp"
#include "mcap/repeated.hpp"
#include "runtime/json.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
using mcap::valueOf;

/// One topic and type, all its writers together.
struct TopicSummary {
  std::set<std::string> writers;  // services; the GUID of one that has no name
  std::uint64_t messages = 0;
  std::optional<std::uint64_t> gaps;  // missing between messages of its writers; nothing where numbers do not say so
  std::uint64_t first_ns = 0;
  std::uint64_t last_ns = 0;

  /// Mean over log time [Hz].
  [[nodiscard]] double rate() const {
    return last_ns > first_ns ? static_cast<double>(messages - 1) / (static_cast<double>(last_ns - first_ns) * 1e-9)
                              : 0.0;
  }
};

struct BagSummary {
  std::string file;
  mcap::FileInfo info;
  mcap::StringMap run;                         // "baton.run": what it is a recording of
  std::optional<mcap::StringMap> certificate;  // "baton.certificate"
  std::vector<std::string> holes;              // parts that are missing between the files
  std::string next_part;                       // "baton.part_end": the file that goes on with it
  std::vector<std::string> damage;
  std::uint64_t messages = 0;  // that could be read, as all that follows
  std::uint64_t plain_bytes = 0;
  std::uint64_t start_ns = 0;
  std::uint64_t end_ns = 0;
  LogTimes log_times;
  std::map<std::pair<std::string, std::string>, TopicSummary> topics;  // by name and type
  std::vector<mcap::AttachmentIndex> attachments;

  [[nodiscard]] double duration() const { return static_cast<double>(end_ns - start_ns) * 1e-9; }
  /// Message records as they were before compression, to the size of the file.
  [[nodiscard]] double compression() const {
    return static_cast<double>(plain_bytes) / static_cast<double>(std::max<std::uint64_t>(1, info.file_bytes));
  }
};

RecordingVerdict verdictOn(const BagSummary& bag) {
  if (!bag.damage.empty()) return RecordingVerdict::kDamaged;
  if (bag.info.is_cut) return RecordingVerdict::kCut;
  if (!bag.info.is_complete) return RecordingVerdict::kIncomplete;  // bytes in it are of no recording
  // What a certificate is of is not this file as it is.
  if (!bag.info.contradictions.empty() && (bag.certificate || !bag.run.empty())) return RecordingVerdict::kIncomplete;
  if (!bag.holes.empty()) return RecordingVerdict::kIncomplete;
  // A finished file of somebody else has none; the parts of one recording have one, in the last.
  const bool needs_certificate = !bag.run.empty() && bag.next_part.empty();
  const bool is_certified = bag.certificate && valueOf(*bag.certificate, "complete") == "true";
  return is_certified || (!bag.certificate && !needs_certificate) ? RecordingVerdict::kComplete
                                                                  : RecordingVerdict::kIncomplete;
}

/// What a file may leave empty, for a line that goes on behind it.
std::string orUnknown(const std::string& text) { return text.empty() ? "unknown" : text; }

/// What the verdict rests on, in a sentence.
std::string reasonFor(const BagSummary& bag) {
  if (!bag.damage.empty()) return bag.damage.front();
  if (!bag.info.is_complete) return bag.info.problem;
  if (verdictOn(bag) == RecordingVerdict::kIncomplete && !bag.info.contradictions.empty()) {
    return "it contradicts itself, so that no certificate holds for it";
  }
  if (!bag.holes.empty()) return fmt::format("{}", fmt::join(bag.holes, "; "));
  if (bag.certificate) return "by its certificate: " + orUnknown(valueOf(*bag.certificate, "summary"));
  if (!bag.next_part.empty()) return "a part of a recording that goes on in " + bag.next_part;
  return bag.run.empty() ? "finished; it was not recorded by Baton and has no certificate" : "it has no certificate";
}

/// Reads all messages, so that every CRC is checked and every gap is found. What the recording repeats from before its
/// beginning is counted, and says nothing of clocks and gaps.
void readMessages(const mcap::JoinedReader& reader, BagSummary& bag) {
  mcap::Repeated repeated = reader.repeated();
  std::map<mcap::ChannelId, SequenceGaps*> counted;  // null: of one whose numbers count something else
  std::map<std::pair<TopicSummary*, std::string>, SequenceGaps> writers;
  reader.forEachMessage({.order = mcap::MessageFilter::Order::kFile}, [&](const mcap::MessageView& message) {
    const mcap::Channel& channel = *message.channel;
    const std::string type = valueOf(channel.metadata, "type");
    const bool has_type = !type.empty() || message.schema == nullptr;
    TopicSummary& topic = bag.topics[{channel.topic, has_type ? type : message.schema->name}];
    const auto [gaps, is_first] = counted.try_emplace(channel.id, nullptr);
    if (is_first) {
      const std::string service = valueOf(channel.metadata, "service"), guid = valueOf(channel.metadata, "writer");
      if (const std::string& writer = service.empty() ? guid : service; !writer.empty()) topic.writers.insert(writer);
      // A channel of one DDS writer has its sequence numbers. In other files they may be anything, such as one count
      // for all channels.
      if (dds::guidCalled(guid)) gaps->second = &writers[{&topic, guid}];
    }
    const bool is_repeated = repeated.takes(message);
    if (gaps->second != nullptr && !is_repeated) gaps->second->add(message.sequence);
    topic.first_ns = topic.messages == 0 ? message.log_time_ns : std::min(topic.first_ns, message.log_time_ns);
    topic.last_ns = std::max(topic.last_ns, message.log_time_ns);
    ++topic.messages;
    bag.start_ns = bag.messages == 0 ? message.log_time_ns : std::min(bag.start_ns, message.log_time_ns);
    bag.end_ns = std::max(bag.end_ns, message.log_time_ns);
    if (!is_repeated) bag.log_times.add(channel.id, message.log_time_ns);
    ++bag.messages;
    bag.plain_bytes += mcap::kMessageHeadBytes + message.data.size();
  });
  for (const auto& [key, gaps] : writers) key.first->gaps = key.first->gaps.value_or(0) + gaps.missing();
}

BagSummary summarize(const RecordingWish& wish) {
  BagSummary bag;
  const FoundRecording recording = findRecording(wish);
  bag.file = recording.files.string();
  bag.holes = recording.missing;
  const bool is_one = recording.files.paths().size() == 1;
  const mcap::JoinedReader reader(recording.files, [&](const std::filesystem::path& file, const mcap::Damage& found) {
    bag.damage.push_back((is_one ? "" : file.string() + ": ") + mcap::describe(found));
  });
  bag.info = reader.info();
  bag.attachments = reader.attachments();
  readMessages(reader, bag);
  try {
    for (const mcap::Metadata& metadata : reader.metadata()) {
      if (metadata.name == "baton.run") bag.run = metadata.values;
      if (metadata.name == "baton.certificate") bag.certificate = metadata.values;
      if (metadata.name == "baton.part") bag.next_part.clear();
      if (metadata.name == "baton.part_end") bag.next_part = valueOf(metadata.values, "next");
    }
    for (const mcap::AttachmentIndex& attachment : reader.attachments()) (void)reader.readAttachment(attachment);
  } catch (const mcap::FormatError& error) {
    bag.damage.emplace_back(error.what());
  }
  return bag;
}

void printTopics(const BagSummary& bag) {
  std::size_t name_width = 5, type_width = 4;
  for (const auto& [key, topic] : bag.topics) {
    name_width = std::max(name_width, escaped(key.first).size());
    type_width = std::max(type_width, escaped(key.second).size());
  }
  sayf("\n{:<{}}  {:<{}}  {:>9}  {:>9}  {:>6}  writers\n", "topic", name_width, "type", type_width, "messages",
       "rate [Hz]", "gaps");
  for (const auto& [key, topic] : bag.topics) {
    sayf("{:<{}}  {:<{}}  {:>9}  {:>9.1f}  {:>6}  {}\n", key.first, name_width, key.second, type_width, topic.messages,
         topic.rate(), topic.gaps ? fmt::to_string(*topic.gaps) : "-",
         fmt::format("{}", fmt::join(topic.writers, ", ")));
  }
}

/// What a reader should know although all of it could be read.
std::vector<std::string> notesOn(const BagSummary& bag) {
  std::vector<std::string> notes = bag.info.contradictions;
  if (bag.info.is_complete && !bag.info.problem.empty()) notes.insert(notes.begin(), bag.info.problem);
  return notes;
}

void printText(const BagSummary& bag) {
  sayf("{}: {}\n", bag.file, nameOf(verdictOn(bag)));
  sayf("            {}\n", reasonFor(bag));
  for (std::size_t i = 1; i < bag.damage.size(); ++i) sayf("            {}\n", bag.damage[i]);
  for (const std::string& note : notesOn(bag)) sayf("note        {}\n", note);
  if (!bag.run.empty()) {
    const auto of = [&](const char* key) { return orUnknown(valueOf(bag.run, key)); };
    if (of("kind") == "traffic") {
      sayf("recorded    traffic of domain {} on {} (interfaces: {}), begun {}\n", of("domain"), of("host"),
           of("interfaces"), of("begun"));
    } else {
      sayf("recorded    {} with robot {}, run {} of cell {} on {}\n", of("scenario"), of("robot"), of("run"),
           of("cell"), of("host"));
    }
    sayf("by          Baton {}, {} ({})\n", of("version"), of("compiler"), of("flags"));
  }
  sayf("messages    {} in {:.3f} s\n", bag.messages, bag.duration());
  for (const std::string& text : bag.log_times.findings()) sayf("note        {}\n", text);
  sayf("size        {:.2f} MB, messages compressed {:.2f} : 1\n", static_cast<double>(bag.info.file_bytes) * 1e-6,
       bag.compression());
  for (const mcap::AttachmentIndex& attachment : bag.attachments) {
    sayf("attachment  {} ({}, {})\n", attachment.name, orUnknown(attachment.media_type),
         counted(attachment.data_size, "byte"));
  }
  printTopics(bag);
}

nlohmann::ordered_json toJson(const BagSummary& bag) {
  nlohmann::ordered_json topics = nlohmann::ordered_json::array();
  for (const auto& [key, topic] : bag.topics) {
    topics.push_back({{"topic", key.first},
                      {"type", key.second},
                      {"writers", topic.writers},
                      {"messages", topic.messages},
                      {"rate_Hz", topic.rate()},
                      {"gaps", nullptr}});
    if (topic.gaps) topics.back()["gaps"] = *topic.gaps;
  }
  nlohmann::ordered_json attachments = nlohmann::ordered_json::array();
  for (const mcap::AttachmentIndex& attachment : bag.attachments) {
    attachments.push_back(
        {{"name", attachment.name}, {"media_type", attachment.media_type}, {"size_B", attachment.data_size}});
  }
  nlohmann::ordered_json json{{"file", bag.file},
                              {"verdict", nameOf(verdictOn(bag))},
                              {"reason", reasonFor(bag)},
                              {"damage", bag.damage},
                              {"notes", notesOn(bag)},
                              {"cut_at_B", nullptr},
                              {"run", bag.run},
                              {"certificate", nullptr},
                              {"messages", bag.messages},
                              {"start_ns", bag.start_ns},
                              {"duration_s", bag.duration()},
                              {"clock", bag.log_times.findings()},
                              {"size_B", bag.info.file_bytes},
                              {"compression_ratio", bag.compression()},
                              {"attachments", attachments},
                              {"topics", topics}};
  if (bag.info.is_cut) json["cut_at_B"] = bag.info.complete_bytes;
  if (bag.certificate) {
    json["certificate"] = {{"complete", valueOf(*bag.certificate, "complete") == "true"},
                           {"summary", valueOf(*bag.certificate, "summary")}};
  }
  return json;
}

struct InfoRequest {
  RecordingWish recording;
  bool json = false;
};

}  // namespace

void addBagInfo(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<InfoRequest>();
  CLI::App* command = bag.add_subcommand("info", "what a recording is of, what is in it, and whether it is whole");
  command->footer(
      "Reads the whole file, so that every checksum is checked and every gap is found. Gaps are counted per writer\n"
      "where the file says that its sequence numbers are a DDS writer's; `-` where they may be anything.\n"
      "Exit codes: 0 complete, 1 incomplete or cut, 2 damaged or not a recording, 3 cannot be opened.");
  addRecording(*command, request->recording);
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] {
    const BagSummary summary = summarize(request->recording);
    if (request->json) {
      // Text in a recording may come from anywhere.
      sayText(toText(toJson(summary)) + '\n');
    } else {
      printText(summary);
    }
    exit_code = exitCodeOf(verdictOn(summary));
  });
}

}  // namespace baton
