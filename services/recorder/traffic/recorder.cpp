#include "traffic/recorder.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "base/text.hpp"
#include "dds/interfaces.hpp"
#include "runtime/cell.hpp"
#include "runtime/log.hpp"
#include "runtime/recording_parts.hpp"
#include "runtime/say.hpp"
#include "runtime/signals.hpp"
#include "traffic/options.hpp"

namespace baton {
namespace {

constexpr std::size_t kMostQueued = std::size_t{256} << 20;
constexpr std::size_t kWakeAfter = 1024;

std::string nameOf(int signal) {
  if (signal == SIGINT) return "Ctrl-C";
  return signal == SIGQUIT ? "Ctrl-\\" : std::string("SIG") + sigabbrev_np(signal);
}

}  // namespace

TrafficRecorder::TrafficRecorder(TrafficOptions options)
    : options_(std::move(options)),
      participant_(participantOptions()),
      queue_(kMostQueued, kWakeAfter, participant_.clock()),
      topics_(participant_, executor_, rules(),
              [this](std::uint32_t topic, bool, const dds::RawSample& sample) { (void)queue_.push(topic, sample); }),
      session_(options_, claimRecording("FILE", options_.out, options_.recording.isSplit(), options_.overwrite), queue_,
               topics_) {
  for (const int number : endingSignals()) signals_.add(number);
}

/// A guest in other people's domain: when it is killed, their reliable writers soon stop waiting for it. Not as soon as
/// they might: where Fast DDS 2.9.1 looks whether its peers are alive, a peer that leaves just then ends the process,
/// and a run has several.
dds::ParticipantOptions TrafficRecorder::participantOptions() const {
  constexpr int kLease_s = 60;
  std::vector<std::string> read = readPartitions(options_.partitions);
  std::vector<std::string> cells;
  for (const RunInfo& run : activeRuns()) {
    if (run.domain == options_.domain) cells.push_back(run.cell);
  }
  const std::string first = read.front();
  read.erase(read.begin());
  return {.domain = options_.domain,
          .partition = first,
          .also_read = std::move(read),
          .addresses = dds::addressesOf(options_.interfaces, dds::interfaces()),
          .lease_s = kLease_s,
          .cell = "",
          .other_cells = std::move(cells),
          .run = "",
          .service = "traffic-recorder"};
}

ReadingRules TrafficRecorder::rules() {
  ReadingRules rules;
  rules.selection = options_.selection;
  rules.is_wanted = [this, read = readPartitions(options_.partitions)](const dds::DiscoveredWriter& writer) {
    if (!isInPartitions(writer.partitions, read)) return false;
    if (isPlain(writer.topic) && isPlain(writer.type)) return true;
    topics_.refuse(
        writer.topic,
        "a writer of " + dds::toString(writer.guid) +
            " is not recorded: control characters in the name of its topic or type, or bytes that are not UTF-8");
    return false;
  };
  rules.on_unreadable = [](const std::string& text) { spdlog::error("{}", text); };
  rules.another = [this] { return std::make_unique<dds::Participant>(participantOptions()); };
  return rules;
}

TrafficResult TrafficRecorder::run() {
  awaitSignal();
  awaitDuration();
  topics_.watch();
  TrafficResult result;
  std::thread writing([&] {
    result = session_.run();
    executor_.stop();
  });
  executor_.run();
  writing.join();
  topics_.stopWatching();
  return result;
}

void TrafficRecorder::awaitSignal() {
  signals_.async_wait([this](const boost::system::error_code& error, int signal) {
    if (error) return;
    if (std::exchange(is_ending_, true)) {
      say(stderr, "the file is being finished; kill -9 would leave it without its index\n");
    }
    session_.end(TrafficEnd::kSignal, "ended by " + nameOf(signal));
    awaitSignal();
  });
}

void TrafficRecorder::awaitDuration() {
  if (!options_.duration_s) return;
  duration_.expires_after(std::chrono::milliseconds(static_cast<std::int64_t>(*options_.duration_s * 1e3)));
  duration_.async_wait([this](const boost::system::error_code& error) {
    if (!error) session_.end(TrafficEnd::kReached, fmt::format("--duration, {:g} s, is over", *options_.duration_s));
  });
}

ExitCode recordTraffic(int argc, const char* const* argv) {
  const HeldSignals held;
  TrafficOptions options;
  if (!parseTrafficOptions(argc, argv, options)) return ExitCode::kOk;
  setUpLog("record");
  TrafficRecorder recorder(options);
  held.release();
  const TrafficResult result = recorder.run();
  sayText((options.json ? jsonOf(result, options) : textOf(result, options)) + '\n');
  return exitCodeOf(result, options);
}

}  // namespace baton
