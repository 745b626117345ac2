// `baton bench recorder`: the recorder as a process, end to end: what it takes from several writers that are no part of
// the run, and what syncing its file costs a run. What is compared takes turns, round after round.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "bench/statistics.hpp"
#include "highest_rate.hpp"
#include "measure.hpp"
#include "payload.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/run.hpp"
#include "sync_cost.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;

constexpr double kTargetRate = 50e3;  // messages a second, without a loss

struct RecorderPlan {
  Load load;
  double up_to = 400e3;
  int rounds = 3;
  int steps = 20'000;  // of a run whose recording is synced
  std::string disk = std::filesystem::temp_directory_path().string();
  std::string only;
  bool as_json = false;
};

struct Results {
  std::vector<Climb> climbs;                               // one a round
  std::map<std::string, std::vector<double>> steps_per_s;  // by what is synced, one a round
};

Results measureAll(const RecorderPlan& plan) {
  const Scratch disk(plan.disk);
  const std::filesystem::path file = disk.file("bench.mcap");
  Programs programs;
  ProgressLine progress;
  Results results;
  for (int round = 0; round < plan.rounds; ++round) {
    const std::string where = "round " + std::to_string(round + 1) + " of " + std::to_string(plan.rounds) + ": ";
    if (plan.only != "sync") {
      results.climbs.push_back(climb(plan.load.rate, plan.up_to, [&](double rate) {
        progress.show(where + std::to_string(std::lround(rate)) + " messages/s");
        Load load = plan.load;
        load.rate = rate;
        return recordUnder(load, file, programs);
      }));
    }
    for (std::size_t i = 0; i < kSyncs.size() && plan.only != "load"; ++i) {
      // Another one first each time: a machine that gets slower or faster favours none.
      const std::string& sync = kSyncs[(i + static_cast<std::size_t>(round)) % kSyncs.size()];
      progress.show(where + "a run, sync " + sync);
      results.steps_per_s[sync].push_back(stepsPerSecond(sync, plan.steps, file, programs));
    }
  }
  return results;
}

std::vector<Row> loadRows(const RecorderPlan& plan, const std::vector<Climb>& climbs) {
  std::vector<double> sent_per_s, highest, recorder_MB;
  std::uint64_t sent = 0, lost = 0;
  for (const Climb& one : climbs) {
    const Recorded& first = one.measured.front();
    sent_per_s.push_back(first.sent_per_s);
    recorder_MB.push_back(first.recorder_MB);
    for (const WriterCount& writer : first.writers) sent += writer.sent;
    lost += first.lost();
    highest.push_back(one.highest);
  }
  const std::string at = " at " + std::to_string(std::lround(plan.load.rate)) + "/s";
  return {{"sent" + at, median(sent_per_s), "msg/s"},
          {"sent" + at + ", all rounds", static_cast<double>(sent), "msg"},
          {"recorded" + at + ", all rounds", static_cast<double>(sent - lost), "msg"},
          {"lost" + at + ", all rounds", static_cast<double>(lost), "msg", 0.0, true},
          {"recorder: memory" + at, median(recorder_MB), "MB"},
          {"highest rate without a loss", median(highest), "msg/s", kTargetRate}};
}

std::vector<Row> syncRows(const std::map<std::string, std::vector<double>>& steps_per_s) {
  const std::vector<double>& without = steps_per_s.at(kSyncs.front());
  std::vector<Row> rows{{"run, sync " + kSyncs.front(), median(without), "steps/s"}};
  for (auto sync = kSyncs.begin() + 1; sync != kSyncs.end(); ++sync) {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < without.size(); ++round) {
      ratios.push_back(steps_per_s.at(*sync)[round] / without[round]);
    }
    rows.push_back({"run, sync " + *sync, median(steps_per_s.at(*sync)), "steps/s"});
    rows.push_back({"run, sync " + *sync + " / sync " + kSyncs.front(), median(ratios), ""});
  }
  return rows;
}

Json toJson(const std::vector<Climb>& climbs) {
  Json rounds = Json::array();
  for (const Climb& climb : climbs) {
    Json measured = Json::array();
    for (const Recorded& one : climb.measured) {
      Json writers = Json::array();
      for (const WriterCount& writer : one.writers) {
        writers.push_back({{"name", writer.name}, {"sent", writer.sent}, {"recorded", writer.recorded}});
      }
      measured.push_back({{"asked_per_s", one.asked},
                          {"sent_per_s", one.sent_per_s},
                          {"lost", one.lost()},
                          {"complete", one.is_complete},
                          {"writers", writers}});
    }
    rounds.push_back(
        {{"highest_per_s", climb.highest}, {"is_loss_above", climb.is_loss_above}, {"measured", measured}});
  }
  return rounds;
}

ExitCode run(int argc, char** argv) {
  RecorderPlan plan;
  CLI::App app{
      "Measures the recorder as a process: foreign writers beside a run, at a steady rate and then at higher ones\n"
      "until something is lost, each message counted in the file; and how fast a run is whose recording is synced.\n"
      "Medians over the rounds. Exit code 0 when all was measured, whatever the figures."};
  app.name("baton bench recorder");
  app.add_option("--writers", plan.load.writers, "processes that publish")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--topics", plan.load.topics, "that each of them publishes")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--bytes", plan.load.bytes, "of a message")
      ->check(CLI::Range(static_cast<int>(kMinPayload), 60'000))
      ->capture_default_str();
  app.add_option("--rate", plan.load.rate, "messages a second, of all writers together")
      ->check(CLI::Range(10.0, 10e6))
      ->capture_default_str();
  app.add_option("--up-to", plan.up_to, "no higher rate than this is tried")->capture_default_str();
  app.add_option("--seconds", plan.load.seconds, "for so long")->check(CLI::Range(0.1, 3600.0))->capture_default_str();
  app.add_option("--steps", plan.steps, "of a run that is synced")
      ->check(CLI::Range(100, 100'000'000))
      ->capture_default_str();
  app.add_option("--rounds", plan.rounds, "how often each is done")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--disk", plan.disk, "a folder on the disk")->capture_default_str();
  app.add_option("--only", plan.only, "load or sync")->check(CLI::IsMember({"load", "sync"}));
  app.add_flag("--json", plan.as_json, "print JSON; the table goes to standard error");
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;

  const Results results = measureAll(plan);
  std::vector<Row> rows;
  if (!results.climbs.empty()) rows = loadRows(plan, results.climbs);
  if (!results.steps_per_s.empty()) std::ranges::move(syncRows(results.steps_per_s), std::back_inserter(rows));
  for (const Row& row : rows) print(plan.as_json ? stderr : stdout, row);
  if (plan.as_json) {
    std::cout << toText(Json{{"rows", toJson(rows)}, {"rounds", toJson(results.climbs)}}) << '\n';
  }
  return ExitCode::kOk;
}

}  // namespace
}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench-recorder", [&] { return baton::bench::run(argc, argv); });
}
