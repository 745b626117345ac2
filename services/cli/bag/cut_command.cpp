#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "bag/copy_target.hpp"
#include "bag/selection.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"

namespace baton {
namespace {

struct CutRequest {
  Selection what;
  CopyTarget out;
  bool json = false;
};

mcap::MessageFilter filterFor(const CutRequest& request, const mcap::Reader& reader) {
  const Selection& what = request.what;
  if (!what.from_s && !what.to_s && what.topics.empty()) {
    throw UsageError("expected what to keep: --from, --to or --topics");
  }
  mcap::MessageFilter filter = filterOf(what, reader);
  filter.order = mcap::MessageFilter::Order::kFile;
  return filter;
}

/// What a copy that is not the whole says of itself.
mcap::StringMap cutMetadata(const Selection& what, std::uint64_t kept, std::uint64_t of) {
  mcap::StringMap values{{"file", what.file},
                         {"messages", std::to_string(kept)},
                         {"left_out", std::to_string(of - kept)},
                         {"topics", fmt::format("{}", fmt::join(what.topics, ","))}};
  if (what.from_s) values["from_s"] = fmt::format("{}", *what.from_s);
  if (what.to_s) values["to_s"] = fmt::format("{}", *what.to_s);
  return values;
}

ExitCode cut(const CutRequest& request) {
  const std::string& in = request.what.file;
  const auto reader = openForCopy(in);
  const mcap::MessageFilter filter = filterFor(request, *reader);
  mcap::WriterOptions options = optionsFor(request.out, {in});
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
  if (kept == 0) {
    throw UsageError(fmt::format("expected messages in these topics and times, found none: {} has {} in {:.6f} s", in,
                                 of, mcap::durationOf(*reader)));
  }
  copy.metadata("baton.cut", cutMetadata(request.what, kept, of));
  copy.finish();
  if (request.json) {
    std::puts(toText({{"file", in}, {"out", request.out.file}, {"messages", kept}, {"left_out", of - kept}}).c_str());
  } else {
    fmt::print("cut         {}: {} of {} messages of {}\n", request.out.file, kept, of, in);
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
      "Exit codes: 0 done; 1 OUT could not be written; 2 wrong input, nothing to keep, damaged or not a recording\n"
      "(`bag recover` makes a sound one); 3 FILE cannot be opened, or OUT is there already or cannot be made.");
  addTopicSelection(*command, request->what);
  addTarget(*command, request->out);
  addTimeSelection(*command, request->what);
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] { exit_code = cut(*request); });
}

}  // namespace baton
