#include "options.hpp"

#include <filesystem>

#include "base/error.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "runtime/command_line.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

constexpr std::int64_t kMostReaders = 1000;

/// The value behind --loop; none stands for passes without end.
std::uint32_t parsePasses(const std::string& text) {
  if (text.empty()) return 0;
  const auto passes = numberIn<std::uint32_t>(text);
  if (!passes || *passes == 0) {
    throw UsageError("--loop: expected a number of passes above 0, or nothing, found '" + text +
                     "'; a recording goes before --loop");
  }
  return *passes;
}

std::map<std::string, std::string> parseRemap(const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> remap;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size()) {
      throw UsageError("--remap: expected old=new, found '" + pair + "'");
    }
    const std::string old_name = pair.substr(0, equals);
    if (!remap.emplace(old_name, pair.substr(equals + 1)).second) {
      throw UsageError("--remap: expected each topic once, found " + old_name + " again");
    }
  }
  return remap;
}

}  // namespace

bool parseReplayOptions(int argc, const char* const* argv, ReplayOptions& options) {
  std::string rate = "1";
  std::string passes;
  std::vector<std::string> remap;
  CLI::App app{
      "Publishes a recording again: the recorded bytes, on the recorded topics, with their source timestamps, their\n"
      "QoS and in their rhythm. It speaks in the partition cell/run, so give both to whoever listens. A recording\n"
      "that was cut or damaged is replayed as far as it can be read.\n"
      "On a terminal: space pauses and resumes; right: 1 s ahead, in a pause the next message; left: 1 s back;\n"
      "+ and - double and halve the rate; q ends it. From elsewhere: `baton player`."};
  app.footer(
      std::string(kRangeHelp) +
      "A range that begins in the middle begins with what a late joiner would have been given there: of each writer\n"
      "of a transient-local topic the latest samples, as many as it keeps. A seek on the way sends nothing again.\n"
      "Exit codes: 0 all was replayed, or as much as was asked for; 1 the recording is cut or damaged, or a topic in\n"
      "it cannot be replayed, and the rest was replayed, or a message was later than --max-late-us; 2 wrong input\n"
      "or not a recording, 3 the file or DDS is not available, 130 interrupted.");
  addRecording(app, options.recording);
  addDomain(app, options.domain)->envname("BATON_DOMAIN");
  addCell(app, options.cell);
  app.add_option("--run", options.run, "run to speak in (default: a new one)");
  app.add_option("--partition", options.partition,
                 "be heard in this DDS partition as well; '' for listeners that set none");
  addTransport(app, options.transport);
  app.add_option("--interface", options.interfaces,
                 "publish on these, by name or IPv4 address, or all; programs that keep off the loopback need that")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--topics", options.topics, "only these topics: a,b,c")->delimiter(',')->allow_extra_args(false);
  app.add_option("--remap", remap, "publish topics under other names: old=new ...");
  app.add_option(
         "--rate", rate,
         "recorded seconds per second, or max; above 1 it waits for slow readers rather than let them lose messages")
      ->capture_default_str();
  addRange(app, options.range);
  app.add_flag("--no-latched", options.without_latched,
               "of a range that begins in the middle, do not send first what transient-local topics keep for late "
               "joiners");
  app.add_option("--skip-gaps", options.longest_gap_s,
                 "wait no longer than so many s (of log time) where nothing was logged, as after a clock was set")
      ->check(notNegative());
  CLI::Option* loop = app.add_option("--loop", passes,
                                     "N times in all, or without end: at once from the start again, with the source "
                                     "timestamps of the recording, which go back; sequence numbers go on")
                          ->expected(0, 1)
                          ->type_name("[N]");
  app.add_flag("--paused", options.starts_paused, "wait in front of the first message until something is asked for");
  app.add_option("--wait-for", options.wait_for, "wait until this many processes read each topic")
      ->check(wholeBetween(0, kMostReaders))
      ->capture_default_str();
  app.add_option("--wait-for-readers", options.wait_for_readers,
                 "wait until each of these services reads a topic: recorder,environment")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--overdue-us", options.overdue_us, "count messages that are later than this")
      ->check(notNegative())
      ->capture_default_str();
  app.add_option("--max-late-us", options.max_late_us, "exit code 1 when a message was later than this")
      ->check(notNegative());
  addScheduling(app, options.scheduling);
  app.add_flag("--json", options.json, "the summary as a JSON object");
  if (!parseCommandLine(app, argc, argv)) return false;
  options.rate = parseRate("--rate", rate, kMaxReplayRate);
  options.remap = parseRemap(remap);
  if (loop->count() > 0) options.passes = parsePasses(passes);
  expectOneRange(options.range);
  const std::vector<std::string>& given = options.recording.given;
  options.file = mcap::FileList(std::vector<std::filesystem::path>(given.begin(), given.end())).string();
  if (options.max_late_us && options.rate <= 0.0) {
    throw UsageError("--max-late-us: expected a --rate at which messages have their time, found max");
  }
  if (options.run.empty()) options.run = newRunId();
  if (!isFileName(options.run, "")) {
    throw UsageError("--run: expected a name without / that does not begin with a dot, found " + options.run);
  }
  return true;
}

}  // namespace baton
