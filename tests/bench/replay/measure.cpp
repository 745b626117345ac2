#include "measure.hpp"

#include <sys/prctl.h>
#include <time.h>

#include <cstdlib>
#include <mutex>

#include "base/error.hpp"
#include "base/splitmix64.hpp"
#include "dds/endpoint.hpp"
#include "playlist.hpp"
#include "recording.hpp"
#include "sleeper.hpp"

namespace baton::bench {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;

}  // namespace

Histogram sleepThrough(int ticks) {
  prctl(PR_SET_TIMERSLACK, 1);  // as the replayer does
  Histogram lateness_ns;
  const std::int64_t begin_ns = steadyNow() + kMillisecond;
  for (int i = 0; i < ticks; ++i) {
    const std::int64_t due_ns = begin_ns + i * kMillisecond;
    const timespec until{.tv_sec = due_ns / kSecond, .tv_nsec = due_ns % kSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
    lateness_ns.record(steadyNow() - due_ns);
  }
  return lateness_ns;
}

Replay replayOnce(Programs& programs, const std::string& file, int ticks, const std::vector<std::string>& options) {
  std::mutex mutex;
  Replay replay;
  int arrived = 0;
  std::int64_t last_ns = 0;
  dds::Participant participant({.domain = programs.domain(),
                                .partition = "bench/replay",
                                .cell = "bench",
                                .run = "replay",
                                .service = "listener"});
  const dds::RawReader reader(participant, {.topic = kTopic, .type = kType}, [&](const dds::RawSample&) {
    const std::int64_t now_ns = steadyNow();
    const std::lock_guard lock(mutex);
    if (arrived++ > 0) replay.interval_error.record(std::abs(now_ns - last_ns - kMillisecond));
    last_ns = now_ns;
  });
  std::vector<std::string> arguments{file,         "--cell", "bench",  "--run",    "replay",
                                     "--wait-for", "1",      "--json", "--domain", std::to_string(programs.domain())};
  arguments.insert(arguments.end(), options.begin(), options.end());
  replay.summary = programs.run("baton-replayer", arguments);
  const std::lock_guard lock(mutex);
  if (arrived != ticks) {
    throw Error(ExitCode::kFailed,
                "expected " + std::to_string(ticks) + " messages of the replay, heard " + std::to_string(arrived));
  }
  return replay;
}

Histogram seekAround(const std::string& file, int times) {
  ReplayOptions options;
  options.recording.given = {file};
  Playlist playlist(options);
  Histogram duration_ns;
  std::uint64_t random = 1;
  for (int i = 0; i < times; ++i) {
    const std::uint64_t position_ns = splitmix(random += kSplitmixStep) % (playlist.duration() + 1);
    const std::uint64_t log_time_ns = playlist.startTime() + position_ns;
    const std::int64_t begin_ns = steadyNow();
    playlist.seek(log_time_ns);
    mcap::MessageView message;
    const bool is_there = playlist.next(message);
    duration_ns.record(steadyNow() - begin_ns);
    if (!is_there || message.log_time_ns < log_time_ns) {
      throw Error(ExitCode::kFailed, "a seek did not go where it was told");
    }
  }
  return duration_ns;
}

}  // namespace baton::bench
