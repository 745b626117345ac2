#include "options.hpp"

#include <charconv>
#include <cmath>

#include "base/error.hpp"
#include "runtime/command_line.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

double parseRate(const std::string& text) {
  if (text == "max") return 0.0;
  double rate = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(rate) || rate <= 0.0) {
    throw UsageError("--rate: expected a number above 0, or max, found '" + text + "'");
  }
  return rate;
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
  std::vector<std::string> remap;
  CLI::App app{
      "Publishes a recording again: the recorded bytes, on the recorded topics, with their source timestamps and in\n"
      "their rhythm. It speaks in the partition cell/run, so give both to whoever listens.\n"
      "A recording that was cut or damaged is replayed as far as it can be read."};
  app.footer(
      "Exit codes: 0 all was replayed, 1 the recording is cut or damaged and the rest was replayed,\n"
      "2 wrong input or not a recording, 3 the file or DDS is not available, 130 interrupted.");
  app.add_option("file", options.file, "recording (MCAP)")->required();
  addDomain(app, options.domain)->envname("BATON_DOMAIN");
  addCell(app, options.cell);
  app.add_option("--run", options.run, "run to speak in (default: a new one)");
  addTransport(app, options.transport);
  app.add_option("--topics", options.topics, "only these topics: a,b,c")->delimiter(',')->allow_extra_args(false);
  app.add_option(
         "--rate", rate,
         "recorded seconds per second, or max; above 1 it waits for slow readers rather than let them lose messages")
      ->capture_default_str();
  app.add_option("--from", options.from_s, "start here, in s of log time from the recording's first message")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--to", options.to_s, "end here, likewise")->check(CLI::NonNegativeNumber);
  app.add_option("--wait-for", options.wait_for, "wait until this many processes read each topic")
      ->capture_default_str();
  app.add_option("--remap", remap, "publish topics under other names: old=new ...");
  app.add_flag("--json", options.json, "the summary as a JSON object");
  if (!parseCommandLine(app, argc, argv)) return false;
  options.rate = parseRate(rate);
  options.remap = parseRemap(remap);
  if (options.from_s && options.to_s && *options.to_s < *options.from_s) {
    throw UsageError("--to: expected a time that is not before --from");
  }
  if (options.run.empty()) options.run = newRunId();
  return true;
}

}  // namespace baton
