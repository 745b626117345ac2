#include "bag/verify.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "mcap/lookup.hpp"
#include "mcap/reader.hpp"
#include "mcap/repeated.hpp"
#include "report/recording.hpp"
#include "runtime/admission.hpp"
#include "runtime/scenario.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

/// One file of the recording.
struct Part {
  std::string file;
  std::set<mcap::Damage> damage{};  // each pass comes across the same
  std::string unreadable{};         // the first of its metadata and attachments that is; empty: none
  std::unique_ptr<mcap::Reader> reader{};
  mcap::Repeated repeated{};        // what it begins with from before, which is booked where it was recorded
  std::string run{};                // empty: not recorded by Baton
  std::optional<unsigned> index{};  // in a recording that was split
  std::string next{};               // the file in which it goes on; empty: this is the last, or it was cut
};

/// Its metadata and attachments are read here, so that their damage shows.
void openPart(Part& part, const std::function<void(double)>& progress) {
  mcap::ReaderOptions options;
  options.on_damage = [&part](const mcap::Damage& found) { part.damage.insert(found); };
  options.on_progress = [&progress](std::uint64_t done, std::uint64_t of) {
    progress(static_cast<double>(done) / static_cast<double>(of));
  };
  part.reader = std::make_unique<mcap::Reader>(part.file, options);
  try {
    part.run = metadataValue(*part.reader, "baton.run", "run");
    part.index = partIndex(*part.reader);
    part.repeated = mcap::Repeated(*part.reader);
    // Parts that were merged may have kept the word of one of them.
    if (part.index) part.next = metadataValue(*part.reader, "baton.part_end", "next");
    for (const mcap::AttachmentIndex& attachment : part.reader->attachments()) {
      (void)part.reader->readAttachment(attachment);
    }
  } catch (const mcap::FormatError& error) {
    part.unreadable = error.what();
  }
}

/// A part alone proves nothing: which one it is, and what is before and behind it.
std::string placeOf(const Part& part) {
  const auto said = [&](const char* key) { return metadataValue(*part.reader, "baton.part", key); };
  return fmt::format(
      "it is part {} of {}, which was split{}{}: give `bag verify` all the parts, or what `bag merge` "
      "makes of them",
      *part.index, said("first"), *part.index > 0 ? "; before it comes " + said("previous") : "",
      part.next.empty() ? "" : "; it goes on in " + part.next);
}

/// The parts in their order. What is wrong with the set goes to `missing`.
std::vector<Part> openParts(const std::vector<std::string>& files, const std::function<void(double)>& progress,
                            std::vector<std::string>& missing) {
  std::vector<Part> parts(files.size());  // does not grow: the readers' callbacks know their places
  for (std::size_t i = 0; i < files.size(); ++i) {
    parts[i].file = files[i];
    openPart(parts[i], progress);
  }
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.index < b.index; });
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    if (parts.size() > 1 && (!part.index || part.run != parts[0].run || (i > 0 && part.index == parts[i - 1].index))) {
      throw UsageError("expected the parts of one recording, each once; " + part.file + " is none of them");
    }
    const unsigned expected = i == 0 ? firstPartKept(*parts.back().reader) : *parts[i - 1].index + 1;
    if (part.index && *part.index != expected) {
      missing.push_back(fmt::format("part {} is not among the files", expected));
    }
  }
  if (parts.size() == 1 && (!missing.empty() || !parts[0].next.empty())) missing = {placeOf(parts[0])};
  if (parts.size() > 1 && !parts.back().next.empty()) {
    missing.push_back(parts.back().next + ", in which it goes on, is not among the files");
  }
  return parts;
}

class Booking {
 public:
  Booking(Verification& result, const std::vector<Part>& parts, const std::function<void(double)>& progress)
      : result_(result), progress_(progress) {
    for (const Part& part : parts) expected_ += part.reader->statistics().message_count;
  }

  void book(const Part& part) {
    const mcap::Reader& reader = *part.reader;
    // Beside the messages, on another core; what one has read the other finds in the page cache.
    std::future<std::optional<bool>> crc = std::async(std::launch::async, [&] { return reader.dataCrcMatches(); });
    accounts_.clear();
    result_.log_times.nextFile();
    from_before_ = part.repeated;
    reader.forEachMessage({.order = mcap::MessageFilter::Order::kFile},
                          [this](const mcap::MessageView& message) { book(message); });
    const auto tell = [&](std::uint64_t& repeated, std::vector<std::string>& findings) {
      if (repeated == 0) return;
      findings.push_back(fmt::format("{}: {} {} twice, or behind later ones of the same writer", part.file,
                                     counted(repeated, "message"), repeated == 1 ? "comes" : "come"));
      repeated = 0;
    };
    tell(repeated_, result_.missing);
    tell(repeated_foreign_, result_.remarks);
    if (crc.get() == false && part.damage.empty() && part.unreadable.empty()) {
      result_.damage.push_back(part.file + ": the CRC of its data section is wrong: bytes between the chunks changed");
    }
  }

 private:
  struct Account {
    Ledger::Stream* stream = nullptr;
    bool is_known = false;  // whether there is one
  };

  void book(const mcap::MessageView& message) {
    const auto id = static_cast<std::size_t>(message.channel->id);
    if (id >= accounts_.size()) accounts_.resize(id + 1);
    Account& account = accounts_[id];
    if (from_before_.takes(message)) return;
    result_.log_times.add(message.channel->id, message.log_time_ns);
    if (!std::exchange(account.is_known, true)) account.stream = streamOf(*message.channel);
    if (++result_.messages % 0x4000 == 0) {
      progress_(static_cast<double>(result_.messages) / static_cast<double>(expected_));
    }
    if (account.stream == nullptr) return;
    // The file has the low half of the sequence number.
    const ReceivedStream& so_far = account.stream->second;
    const std::uint64_t last = so_far.count == 0 ? message.sequence : so_far.last_sequence;
    const auto growth = static_cast<std::int32_t>(message.sequence - static_cast<std::uint32_t>(last));
    const std::uint64_t sequence = last + static_cast<std::uint64_t>(std::int64_t{growth});
    if (result_.ledger.book(*account.stream, sequence, message.data)) return;
    ++(result_.ledger.isRemarked(message.channel->topic) ? repeated_foreign_ : repeated_);
  }

  Ledger::Stream* streamOf(const mcap::Channel& channel) {
    const auto guid = dds::guidCalled(mcap::valueOf(channel.metadata, "writer"));
    return guid ? &result_.ledger.streamOf({channel.topic, *guid}) : nullptr;
  }

  Verification& result_;
  const std::function<void(double)>& progress_;
  std::uint64_t expected_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t repeated_foreign_ = 0;
  mcap::Repeated from_before_;     // of the present part
  std::vector<Account> accounts_;  // [channel id], of the present part
};

/// From the first part that has it, or from the last: parts may repeat what they are of, and the last one is certified.
std::optional<std::string> attached(const std::vector<Part>& parts, const std::string& name) {
  std::optional<std::string> found;
  for (const Part& part : parts) {
    if (auto text = attachmentText(*part.reader, name)) found = std::move(text);
  }
  return found;
}

/// Everybody of whom a manifest is to be expected, by the scenario in the file.
std::vector<std::string> writersOf(const std::vector<Part>& parts) {
  const auto scenario = attached(parts, "scenario.yaml"), robot = attached(parts, "robot.yaml");
  if (!scenario || !robot) throw UsageError("it has no scenario that says who took part");
  return servicesBut(kRecorderName, parseScenario("scenario.yaml", *scenario, "robot.yaml", *robot));
}

/// Whoever wrote on a topic of the run without being one of its services, whatever it says of itself.
std::set<std::string> strangersIn(const std::vector<Part>& parts, const Ledger& ledger) {
  std::set<std::string> found;
  for (const Part& part : parts) {
    for (const auto& [id, channel] : part.reader->channels()) {
      const dds::TopicFacts* facts = dds::topics::called(channel.topic);
      if (facts == nullptr || facts->written_by == dds::WrittenBy::kOperators) continue;
      if (!channel.metadata.contains("service")) continue;  // nobody asked who it was
      const std::string service = mcap::valueOf(channel.metadata, "service");
      const auto writer = dds::guidCalled(mcap::valueOf(channel.metadata, "writer"));
      // Of controllers that came later the file may have no more than their manifest, or not even that.
      const bool is_of_run = ledger.expects(service) || service == kSupervisorName || service == kRecorderName ||
                             ledger.servicesHeard() == 0 || (writer && ledger.isVouchedFor({channel.topic, *writer}));
      if (is_of_run && mayWrite(facts->written_by, roleCalled(service))) continue;
      found.insert(fmt::format("{}: a writer that is none of the run's services whose topic it is{}", channel.topic,
                               service.empty() ? "" : ", and calls itself " + escaped(service)));
    }
  }
  return found;
}

/// @param are_all  no part of the recording is known to be elsewhere.
void judge(const std::vector<Part>& parts, bool are_all, const std::optional<std::string>& certificate,
           Verification& result) {
  const auto add = [](std::vector<std::string>& to, const std::vector<std::string>& sentences) {
    to.insert(to.end(), sentences.begin(), sentences.end());
  };
  for (const Part& part : parts) {
    for (const mcap::Damage& found : part.damage) result.damage.push_back(part.file + ": " + mcap::describe(found));
    if (!part.unreadable.empty()) result.damage.push_back(part.unreadable);
    const mcap::FileInfo& info = part.reader->info();
    for (const std::string& text : info.contradictions) result.damage.push_back(part.file + ": " + text);
    if (info.problem.empty()) continue;
    const bool is_sound = !info.is_complete || info.is_unindexed;  // there is more in the file, or less in its index
    auto& findings = info.is_cut ? result.cuts : is_sound ? result.missing : result.damage;
    findings.push_back(part.file + ": " + info.problem);
  }
  if (parts[0].run.empty()) {
    result.missing.emplace_back("it was not recorded by Baton: nobody says what was sent");
    return;
  }
  if (!are_all) return;  // what was sent, and what certified, is more than these files have
  try {
    if (!result.is_traffic) {
      for (const std::string& service : writersOf(parts)) result.ledger.expect(service);
    }
    if (certificate) result.ledger.excuse(*certificate);
    if (!result.is_traffic) {
      for (const std::string& text : strangersIn(parts, result.ledger)) result.missing.push_back(text);
    }
    add(result.missing, result.is_traffic ? result.ledger.problemsSoFar() : result.ledger.problems());
    if (!certificate) return result.missing.emplace_back("it has no certificate"), void();
    Ledger::Comparison certified = result.ledger.compare(*certificate);
    add(result.missing, std::move(certified.disagreements));
    add(result.remarks, std::move(certified.remarks));
    const std::string verdict = metadataValue(*parts.back().reader, "baton.certificate", "complete");
    result.summary = metadataValue(*parts.back().reader, "baton.certificate", "summary");
    if (verdict != "true" && result.missing.empty()) result.missing.push_back("its certificate says " + result.summary);
  } catch (const Error& error) {
    result.missing.emplace_back(error.what());
  }
}

}  // namespace

RecordingVerdict Verification::verdict() const {
  if (!damage.empty()) return RecordingVerdict::kDamaged;
  if (!cuts.empty()) return RecordingVerdict::kCut;
  return missing.empty() ? RecordingVerdict::kComplete : RecordingVerdict::kIncomplete;
}

Verification verifyRecording(const std::vector<std::string>& files, const std::function<void(double)>& progress,
                             const std::vector<std::string>& unreadable) {
  Verification result;
  result.damage = unreadable;
  const std::vector<Part> parts = openParts(files, progress, result.missing);
  const bool are_all = result.missing.empty();
  const auto certificate = attached(parts, "certificate.json");
  if (certificate) result.ledger.beginAt(*certificate);
  if (!parts[0].run.empty()) {
    result.is_traffic = metadataValue(*parts[0].reader, "baton.run", "kind") == "traffic";
    if (!result.is_traffic) result.ledger.remarkForeignTopics();
  }
  Booking booking(result, parts, progress);
  for (const Part& part : parts) {
    result.files.push_back(part.file);
    result.bytes += part.reader->info().file_bytes;
    booking.book(part);
  }
  judge(parts, are_all, certificate, result);
  return result;
}

}  // namespace baton
