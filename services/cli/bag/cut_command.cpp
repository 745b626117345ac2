#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bag/copy_target.hpp"
#include "bag/interruption.hpp"
#include "bag/selection.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "base/plural.hpp"
#include "dds/hash.hpp"
#include "mcap/repeated.hpp"
#include "runtime/json.hpp"
#include "runtime/latched.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

struct CutRequest {
  Selection what;
  CopyTarget out;
  bool without_latched = false;
  bool json = false;
};

/// What a copy that is not the whole says of itself.
mcap::StringMap cutMetadata(const Selection& what, const std::string& file, std::uint64_t kept, std::uint64_t of) {
  mcap::StringMap values{{"file", file},
                         {"messages", std::to_string(kept)},
                         {"left_out", std::to_string(of - kept)},
                         {"topics", fmt::format("{}", fmt::join(what.topics, ","))}};
  const auto say = [&](const char* key, const auto& value) {
    if (value) values[key] = fmt::format("{}", *value);
  };
  say("from_s", what.range.from_s);
  say("to_s", what.range.to_s);
  say("from_step", what.range.from_step);
  say("to_step", what.range.to_step);
  say("from_sim_s", what.range.from_sim_s);
  say("to_sim_s", what.range.to_sim_s);
  return values;
}

/// What the recording says of itself, once where several files say the same.
void copyExtras(const mcap::JoinedReader& reader, mcap::Copier& copy) {
  std::set<std::pair<std::string, mcap::StringMap>> metadata;
  for (const mcap::Metadata& one : reader.metadata()) {
    // The copy is no part of a split recording, and what it repeats is said of it below.
    const bool is_of_file = one.name == mcap::kRepeatedRecord || one.name.starts_with("baton.part");
    if (is_of_file || !metadata.emplace(one.name, one.values).second) continue;
    copy.metadata(withoutClaim(one.name), one.values);
  }
  std::set<std::pair<std::string, std::uint64_t>> attachments;  // by name and content
  for (const mcap::AttachmentIndex& index : reader.attachments()) {
    const mcap::Bytes data = reader.readAttachment(index);
    if (!attachments.emplace(index.name, dds::chainHash(0, data)).second) continue;
    copy.attachment(withoutClaim(index.name), index, data);
  }
}

struct Copied {
  std::uint64_t of = 0;        // that were recorded, not repeated
  std::uint64_t kept = 0;      // of what was chosen
  std::uint64_t repeated = 0;  // from before its beginning
};

/// In front, what a late joiner would have been given there; then what was chosen, in the order of the files.
Copied copyMessages(const CutRequest& request, const mcap::JoinedReader& reader, const std::string& in,
                    mcap::Copier& copy) {
  RecordingRange range(request.what.range, reader, in);
  mcap::MessageFilter filter = filterOf(request.what, range, reader);
  filter.order = mcap::MessageFilter::Order::kFile;
  Copied copied;
  if (!request.without_latched) {
    for (LatchedMessage& latched : latchedBefore(reader, filter)) {
      latched.view.log_time_ns = filter.start_time_ns;
      copy.message(latched.view);
      ++copied.repeated;
    }
  }
  ProgressLine line;
  const std::uint64_t begin = std::max(filter.start_time_ns, reader.statistics().start_time_ns);
  const std::uint64_t end = std::min(filter.end_time_ns, reader.statistics().end_time_ns);
  const auto span = static_cast<double>(end > begin ? end - begin : 1);
  mcap::Repeated repeated = reader.repeated();  // of a recording that itself begins in the middle
  copied.of = reader.statistics().message_count - repeated.count();
  reader.forEachMessage(filter, [&](const mcap::MessageView& message) {
    if (!range.takes(message)) return;
    if (repeated.takes(message)) {
      if (request.without_latched) return;
      ++copied.repeated;
    } else {
      ++copied.kept;
    }
    copy.message(message);
    if (copy.messages() % 0x4000 != 0) return;
    const double part = static_cast<double>(message.log_time_ns - begin) / span;
    line.show(fmt::format("cutting {} {:3.0f} %", progressBar(part), 100.0 * part));
  });
  return copied;
}

ExitCode cut(CutRequest& request) {
  removeUnfinishedOnSignals();
  request.out.file = takeLast(request.what.recording.given);
  if (request.what.range.isAll() && request.what.topics.empty()) {
    throw UsageError("expected what to keep: a range (--from, --to-step, ...) or --topics");
  }
  ExitCode exit_code = ExitCode::kOk;
  const mcap::FileList files = findRecording(request.what.recording, exit_code);
  const std::string in = files.string();
  const mcap::JoinedReader reader(files);
  sayHowItIs(in, reader.info());
  std::vector<std::string> inputs;
  for (const std::filesystem::path& path : files.paths()) inputs.push_back(path.string());
  mcap::WriterOptions options = optionsFor(request.out, inputs);
  options.profile = reader.info().header.profile;
  mcap::Copier copy(request.out.file, options);
  copyExtras(reader, copy);
  const Copied copied = copyMessages(request, reader, in, copy);
  if (copied.kept == 0) throw nothingChosen(reader, in);
  copy.metadata("baton.cut", cutMetadata(request.what, in, copied.kept, copied.of));
  if (copied.repeated > 0) copy.metadata(mcap::kRepeatedRecord, mcap::repeatedRecord(copied.repeated));
  copy.finish();
  if (request.json) {
    sayText(toText({{"file", in},
                    {"out", request.out.file},
                    {"messages", copied.kept},
                    {"left_out", copied.of - copied.kept},
                    {"latched", copied.repeated}}) +
            '\n');
  } else {
    sayf("cut         {}: {} of {} of {}\n", request.out.file, copied.kept, counted(copied.of, "message"), in);
    if (copied.repeated > 0) {
      sayf("            and in front {} from before, as a late joiner would have been given them\n", copied.repeated);
    }
  }
  return exit_code;
}

}  // namespace

void addBagCut(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<CutRequest>();
  CLI::App* command = bag.add_subcommand("cut", "a part of a recording: a time, some topics");
  command->footer(
      std::string(kRangeHelp) +
      "A cut that begins in the middle begins with what a late joiner would have been given there: of each writer\n"
      "of a transient-local topic the latest samples, as many as it keeps (of each instance, where the keys are\n"
      "known), with the log time of the beginning. The metadata record baton.latched counts them, and `bag verify`\n"
      "does not. Metadata and attachments are kept. The metadata record baton.cut says what was left out; such a\n"
      "file does not claim to be complete, the certificate of the whole is kept under the name original_...\n"
      "Exit codes: 0 done; 1 OUT could not be written, or a part is missing between the files; 2 wrong input,\n"
      "nothing to keep, damaged or not a recording (`bag recover` makes a sound one); 3 a file cannot be opened, or\n"
      "OUT is there already or cannot be made.");
  addTopicSelection(*command, request->what, "files",
                    "recordings (MCAP) or folders of them, read as one, and then the recording to make");
  addOverwrite(*command, request->out);
  addRange(*command, request->what.range);
  command->add_flag("--no-latched", request->without_latched,
                    "without the samples from before that transient-local topics give to late joiners");
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] { exit_code = cut(*request); });
}

}  // namespace baton
