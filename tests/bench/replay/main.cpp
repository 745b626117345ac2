// `baton bench replay`: how late the messages of a replay at 1 kHz go out, beside a loop that only sleeps, in one
// interleaved run; and how long a seek in a large recording takes.
#include <cstdio>
#include <iostream>

#include "bench/statistics.hpp"
#include "measure.hpp"
#include "recording.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/run.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;

constexpr double kTargetP99_us = 200.0;
constexpr double kTargetSeek_us = 5000.0;

struct Plan {
  int rounds = 5;
  int seconds = 10;
  int fifo = 0;
  int seek_megabytes = 1000;
  bool as_json = false;
};

/// The rounds of one quantity that is measured, a percentile each.
struct Rounds {
  std::vector<double> p50_us, p99_us, max_us;
  void add(double p50, double p99, double max) {
    p50_us.push_back(p50);
    p99_us.push_back(p99);
    max_us.push_back(max);
  }
  void add(const Histogram& ns) {
    const auto us = [&](double p) { return static_cast<double>(ns.quantile(p)) * 1e-3; };
    add(us(0.5), us(0.99), us(1.0));
  }
  [[nodiscard]] Json toJson() const {
    const auto spread = [](const std::vector<double>& rounds) {
      return Json{{"median", median(rounds)}, {"rounds", rounds}};
    };
    return {{"p50_us", spread(p50_us)}, {"p99_us", spread(p99_us)}, {"max_us", spread(max_us)}};
  }
};

Json measureAll(const Plan& plan, Programs& programs) {
  ProgressLine progress;
  const int ticks = plan.seconds * 1000;
  const std::string file = programs.write("ticks.mcap", "");
  std::remove(file.c_str());
  writeRecording(file, {.messages = static_cast<std::uint64_t>(ticks)});
  std::vector<std::string> options;
  if (plan.fifo > 0) options = {"--fifo", std::to_string(plan.fifo)};
  Rounds sleep, replay, reader;
  std::uint64_t overdue = 0;
  const auto measureReplay = [&] {
    const Replay one = replayOnce(programs, file, ticks, options);
    const nlohmann::json& lateness = one.summary.at("lateness_us");
    replay.add(lateness.at("p50"), lateness.at("p99"), lateness.at("max"));
    reader.add(one.interval_error);
    overdue += one.summary.at("overdue").get<std::uint64_t>();
  };
  for (int round = 0; round < plan.rounds; ++round) {
    progress.show("round " + std::to_string(round + 1) + " of " + std::to_string(plan.rounds) + ", " +
                  std::to_string(2 * plan.seconds * (plan.rounds - round)) + " s left");
    // Back and forth: a machine that gets slower or faster favours nobody.
    if (round % 2 == 0) sleep.add(sleepThrough(ticks));
    measureReplay();
    if (round % 2 == 1) sleep.add(sleepThrough(ticks));
  }
  Json report{{"rounds", plan.rounds},
              {"messages", ticks},
              {"rate_hz", 1000},
              {"fifo", plan.fifo},
              {"sleep", sleep.toJson()},
              {"replay", replay.toJson()},
              {"overdue", overdue},
              {"reader", reader.toJson()},
              {"target_p99_us", kTargetP99_us},
              {"reached", median(replay.p99_us) < kTargetP99_us},
              {"seek", nullptr}};
  if (plan.seek_megabytes > 0) {
    progress.show("writing a recording of " + std::to_string(plan.seek_megabytes) + " MB, to seek in");
    const std::string large = programs.write("large.mcap", "");
    std::remove(large.c_str());
    constexpr std::size_t kPayload = 1000;
    writeRecording(large, {.messages = static_cast<std::uint64_t>(plan.seek_megabytes) * 1'000'000 / kPayload,
                           .payload_bytes = kPayload});
    Rounds seek;
    seek.add(seekAround(large, 1000));
    report["seek"] = seek.toJson();
    report["seek"]["megabytes"] = plan.seek_megabytes;
    report["seek"]["target_p99_us"] = kTargetSeek_us;
    report["seek"]["reached"] = seek.p99_us.front() < kTargetSeek_us;
  }
  return report;
}

void printTable(const Json& report, std::FILE* out) {
  std::fprintf(out,
               "A replay at 1 kHz to one reader, %d rounds of %d messages beside a loop that only sleeps; medians\n\n",
               report.at("rounds").get<int>(), report.at("messages").get<int>());
  std::fprintf(out, "%-44s %10s %10s %10s %10s\n", "", "p50 us", "p99 us", "max us", "target p99");
  const auto row = [&](const char* name, const Json& values, const Json& target, const Json& reached) {
    std::fprintf(out, "%-44s", name);
    for (const char* key : {"p50_us", "p99_us", "max_us"}) {
      std::fprintf(out, " %10.1f", values.at(key).at("median").get<double>());
    }
    if (!target.is_null()) {
      std::fprintf(out, " %10.0f   %s", target.get<double>(), reached.get<bool>() ? "reached" : "MISSED");
    }
    std::fputs("\n", out);
  };
  row("lateness of a bare clock_nanosleep", report.at("sleep"), nullptr, nullptr);
  row("lateness of the replay's messages", report.at("replay"), report.at("target_p99_us"), report.at("reached"));
  row("intervals at the reader, off a millisecond", report.at("reader"), nullptr, nullptr);
  if (const Json& seek = report.at("seek"); !seek.is_null()) {
    const std::string name = "a seek in " + std::to_string(seek.at("megabytes").get<int>()) + " MB";
    row(name.c_str(), seek, seek.at("target_p99_us"), seek.at("reached"));
  }
}

ExitCode run(int argc, char** argv) {
  Plan plan;
  CLI::App app{
      "Measures how late the messages of a replay at 1 kHz go out, beside a loop that only sleeps, in turns; and how\n"
      "long a seek in a large recording takes. Exit code 0 when all was measured, whatever the figures."};
  app.name("baton bench replay");
  app.add_option("--rounds", plan.rounds, "how often each is measured")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seconds", plan.seconds, "length of the recording")
      ->check(CLI::Range(1, 3600))
      ->capture_default_str();
  app.add_option("--fifo", plan.fifo, "let the replayer ask for this SCHED_FIFO priority")->check(CLI::Range(1, 99));
  app.add_option("--seek-mb", plan.seek_megabytes, "size of the recording to seek in; 0: leave that out")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  app.add_flag("--json", plan.as_json, "print JSON; the table goes to standard error");
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;
  Programs programs;
  const Json report = measureAll(plan, programs);
  printTable(report, plan.as_json ? stderr : stdout);
  if (plan.as_json) std::cout << toText(report) << '\n';
  return ExitCode::kOk;
}

}  // namespace
}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench-replay", [&] { return baton::bench::run(argc, argv); });
}
