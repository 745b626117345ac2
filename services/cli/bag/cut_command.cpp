#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bag/copy_target.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "control/nearest_name.hpp"
#include "mcap/lookup.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"

namespace baton {
namespace {

struct CutRequest {
  std::string in;
  CopyTarget out;
  std::optional<double> from_s;  // of log time since the first message
  std::optional<double> to_s;
  std::vector<std::string> topics;  // empty: all
  bool json = false;
};

mcap::MessageFilter filterOf(const CutRequest& request, const mcap::Reader& reader) {
  if (!request.from_s && !request.to_s && request.topics.empty()) {
    throw UsageError("expected what to keep: --from, --to or --topics");
  }
  const std::vector<std::string> known = mcap::topicNames(reader);
  for (const std::string& topic : request.topics) {
    if (!std::ranges::binary_search(known, topic)) throw UsageError(unknownName("topic", topic, known));
  }
  mcap::MessageFilter filter{.topics = request.topics, .order = mcap::MessageFilter::Order::kFile};
  if (request.from_s) filter.start_time_ns = mcap::logTimeAt(reader, *request.from_s);
  if (request.to_s) filter.end_time_ns = mcap::logTimeAt(reader, *request.to_s);
  if (filter.end_time_ns < filter.start_time_ns) throw UsageError("--to: expected a time that is not before --from");
  return filter;
}

/// What a copy that is not the whole says of itself.
mcap::StringMap cutMetadata(const CutRequest& request, std::uint64_t kept, std::uint64_t of) {
  mcap::StringMap values{{"file", request.in},
                         {"messages", std::to_string(kept)},
                         {"left_out", std::to_string(of - kept)},
                         {"topics", fmt::format("{}", fmt::join(request.topics, ","))}};
  if (request.from_s) values["from_s"] = fmt::format("{}", *request.from_s);
  if (request.to_s) values["to_s"] = fmt::format("{}", *request.to_s);
  return values;
}

ExitCode cut(const CutRequest& request) {
  const auto reader = openForCopy(request.in);
  const mcap::MessageFilter filter = filterOf(request, *reader);
  mcap::WriterOptions options = optionsFor(request.out, {request.in});
  options.profile = reader->info().header.profile;
  mcap::Copier copy(request.out.file, options);
  for (const mcap::Metadata& one : reader->metadata()) copy.metadata(withoutClaim(one.name), one.values);
  for (const mcap::AttachmentIndex& index : reader->attachments()) {
    copy.attachment(withoutClaim(index.name), index, reader->readAttachment(index));
  }
  {
    ProgressLine line;
    const std::uint64_t begin = std::max(filter.start_time_ns, reader->statistics().start_time_ns);
    const std::uint64_t end = std::min(filter.end_time_ns, reader->statistics().end_time_ns);
    const auto span = static_cast<double>(end > begin ? end - begin : 1);
    reader->forEachMessage(filter, [&](const mcap::MessageView& message) {
      copy.message(message);
      if (copy.messages() % 0x4000 != 0) return;
      const double part = static_cast<double>(message.log_time_ns - begin) / span;
      line.show(fmt::format("cutting {} {:3.0f} %", progressBar(part), 100.0 * part));
    });
  }
  const std::uint64_t kept = copy.messages(), of = reader->statistics().message_count;
  copy.metadata("baton.cut", cutMetadata(request, kept, of));
  copy.finish();
  if (request.json) {
    std::puts(
        toText({{"file", request.in}, {"out", request.out.file}, {"messages", kept}, {"left_out", of - kept}}).c_str());
  } else {
    fmt::print("cut         {}: {} of {} messages of {}\n", request.out.file, kept, of, request.in);
  }
  return ExitCode::kOk;
}

}  // namespace

void addBagCut(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<CutRequest>();
  CLI::App* command = bag.add_subcommand("cut", "a part of a recording: a time, some topics");
  command->footer(
      "Metadata and attachments are kept. The metadata record baton.cut says what was left out; such a file does not\n"
      "claim to be complete, the certificate of the whole is kept under the name original_...\n"
      "Exit codes: 0 done; 1 OUT could not be written; 2 wrong input, damaged or not a recording (`bag recover` makes "
      "a\n"
      "sound one); 3 IN cannot be opened, or OUT is there already or cannot be made.");
  command->add_option("in", request->in, "recording (MCAP)")->required();
  addTarget(*command, request->out);
  command->add_option("--from", request->from_s, "start here, in s of log time from the recording's first message")
      ->check(notNegative());
  command->add_option("--to", request->to_s, "end here, likewise; a message at that time is kept")
      ->check(notNegative());
  command->add_option("--topics", request->topics, "only these topics: a,b,c")->delimiter(',')->allow_extra_args(false);
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] { exit_code = cut(*request); });
}

}  // namespace baton
