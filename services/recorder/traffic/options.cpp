#include "traffic/options.hpp"

#include <fnmatch.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "runtime/command_line.hpp"

namespace baton {
namespace {

/// What is given once or several times, and several with commas between.
CLI::Option* addList(CLI::App& app, const char* name, std::vector<std::string>& values, const char* help) {
  return app.add_option(name, values, help)->delimiter(',')->allow_extra_args(false);
}

std::uint64_t bytesIn(const std::string& option, double megabytes, double least) {
  constexpr double kMost_MB = 1e9;
  if (megabytes >= least && megabytes <= kMost_MB) return static_cast<std::uint64_t>(std::llround(megabytes * 1e6));
  throw UsageError(option + ": expected " + (least > 0.0 ? "0.001" : "0") + " to 1e9 MB, found " +
                   fmt::format("{:g}", megabytes));
}

std::uint64_t millisecondsIn(const std::string& option, double seconds) {
  constexpr double kMost_s = 1e9;
  if (seconds >= 0.001 && seconds <= kMost_s) return static_cast<std::uint64_t>(std::llround(seconds * 1e3));
  throw UsageError(option + ": expected 0.001 to 1e9 s, found " + fmt::format("{:g}", seconds));
}

}  // namespace

bool parseTrafficOptions(int argc, const char* const* argv, TrafficOptions& options) {
  CLI::App app{
      "Records whatever is published in a DDS domain, without a run: every topic and every writer as it appears, of\n"
      "any vendor and any type, the bytes as they were received. Ctrl-C ends it and finishes the file.\n"
      "It listens on all interfaces of this machine, and so to other machines too; Baton's own processes speak on the\n"
      "loopback alone (--interface lo). It only reads: of a run, no byte changes."};
  app.name("baton record traffic");
  app.footer(
      "The file has of each writer what was received, and which of its sequence numbers were not. Traffic carries no\n"
      "word on what was sent before the first and after the last sample, so `bag verify` says complete, as received.\n"
      "What is disposed of is not recorded; a type is kept with the IDL of Baton's own types, else by its name.\n"
      "Exit codes: 0 recorded without a loss; 1 samples are missing, a writer could not be read, nothing came, or the\n"
      "disk is full; 2 wrong input; 3 FILE is there already, or the file or DDS is not available; 130 a signal\n"
      "came before --duration or --max-messages was reached. Without those two, a signal is how it ends: 0 or 1.");
  app.add_option("file", options.out, "recording to make (MCAP)")->required()->type_name("FILE");
  addDomain(app, options.domain)->envname("BATON_DOMAIN");
  addList(app, "--topics", options.selection.topics, "only topics that match: a,b,'rt/*' (patterns of a shell)");
  addList(app, "--except", options.selection.except, "but not those that match, likewise");
  addList(app, "--partition", options.partitions,
          "only writers in matching DDS partitions; '' for those that set none (default: all)");
  addList(app, "--interface", options.interfaces,
          "listen on these alone, by name or IPv4 address: lo, eth0 (default: all)");
  double split_MB = 0.0, split_s = 0.0, max_MB = 0.0;
  double min_free_MB = static_cast<double>(options.recording.min_free_bytes) * 1e-6, duration_s = 0.0;
  CLI::Option* duration = app.add_option("--duration", duration_s, "end after so many seconds");
  app.add_option("--max-messages", options.max_messages, "end after so many messages")->check(atLeastOne());
  CLI::Option* max = app.add_option("--max-MB", max_MB, "end before the files, all parts together, are larger");
  app.add_option("--min-free-MB", min_free_MB, "end before less is left on the disk")->capture_default_str();
  CLI::Option* by_size = app.add_option("--split-MB", split_MB, "begin another file when one is so large");
  CLI::Option* by_time = app.add_option("--split-s", split_s, "begin another file after so many seconds");
  app.add_option("--compression", options.recording.compression, "of the file")
      ->check(CLI::IsMember({"none", "lz4", "zstd"}))
      ->capture_default_str();
  app.add_flag("--overwrite", options.overwrite, "replace FILE if it is there");
  app.add_flag("--json", options.json, "the result as a JSON object");
  if (!parseCommandLine(app, argc, argv)) return false;

  RecordingConfig& recording = options.recording;
  constexpr double kLeast_MB = 0.001;
  if (duration->count() > 0) options.duration_s = static_cast<double>(millisecondsIn("--duration", duration_s)) * 1e-3;
  if (max->count() > 0) recording.max_bytes = bytesIn("--max-MB", max_MB, kLeast_MB);
  if (by_size->count() > 0) recording.split_bytes = bytesIn("--split-MB", split_MB, kLeast_MB);
  if (by_time->count() > 0) recording.split_steps = millisecondsIn("--split-s", split_s);
  recording.min_free_bytes = bytesIn("--min-free-MB", min_free_MB, 0.0);
  // The index comes on top of the chunks: smaller ones where little is allowed.
  for (const std::uint64_t limit : {recording.max_bytes / 4, recording.split_bytes}) {
    constexpr std::size_t kLeastChunk = 1000;
    if (limit > 0) recording.chunk_bytes = std::clamp<std::size_t>(limit, kLeastChunk, recording.chunk_bytes);
  }
  return true;
}

std::vector<std::string> readPartitions(const std::vector<std::string>& patterns) {
  std::vector<std::string> read = patterns.empty() ? std::vector<std::string>{"*"} : patterns;
  const bool has_none = std::ranges::find(read, "") != read.end();
  if (!has_none && isInPartitions({""}, read)) read.emplace_back();
  return read;
}

bool isInPartitions(const std::vector<std::string>& of_writer, const std::vector<std::string>& read) {
  static const std::vector<std::string> kNone{""};
  const auto matches = [](const std::string& pattern, const std::string& name) {
    return fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
  };
  const std::vector<std::string>& theirs = of_writer.empty() ? kNone : of_writer;
  return std::ranges::any_of(theirs, [&](const std::string& one) {
    return std::ranges::any_of(read, [&](const std::string& ours) { return matches(ours, one) || matches(one, ours); });
  });
}

}  // namespace baton
