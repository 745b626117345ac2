#include "cells.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "bench/statistics.hpp"
#include "dds/typed.hpp"
#include "runtime/service_options.hpp"
#include "scenario.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr double kCrawl_steps_per_s = 1e-3;  // until they are let go they do not get beyond step 0

/// Watches the plants of all cells and speaks to them at once.
class Starter {
 public:
  Starter(int domain, const std::string& partitions, std::vector<std::string> cells)
      : participant_({.domain = domain,
                      .partition = partitions,
                      .cell = "",
                      .other_cells = std::move(cells),
                      .run = "",
                      .service = "bench"}),
        statuses_(participant_, dds::topics::kSimStatus,
                  [this](const msg::SimStatus& status, const dds::RawSample& sample) { onStatus(status, sample); }),
        requests_(participant_, dds::topics::kSimRequest) {}

  /// Whether so many plants run and listen.
  [[nodiscard]] bool areRunning(int cells) {
    const std::set<dds::GuidPrefix> listeners = requests_.raw().matched();
    const std::lock_guard lock(mutex_);
    return std::count_if(running_.begin(), running_.end(),
                         [&](const dds::GuidPrefix& plant) { return listeners.contains(plant); }) == cells;
  }

  void letGo() {
    {
      const std::lock_guard lock(mutex_);
      let_go_ = Clock::now();
    }
    msg::SimRequest request;
    request.request_id(1);
    request.action(msg::SIM_RATE);
    request.rate(0.0);  // as fast as possible
    requests_.write(request);
  }

  /// How long a cell had run by then [s], by its plant's own count.
  [[nodiscard]] double elapsedWhenLetGo(const std::string& cell) {
    const std::lock_guard lock(mutex_);
    const Word& word = last_words_.at(cell);
    return word.elapsed_s + std::chrono::duration<double>(let_go_ - word.heard).count();
  }

 private:
  void onStatus(const msg::SimStatus& status, const dds::RawSample& sample) {
    const dds::GuidPrefix prefix = dds::prefixOf(sample.writer);
    const std::optional<dds::Peer> peer = participant_.peer(prefix);
    if (!peer || peer->service != kPlantName || status.state() != msg::SIM_STATE_RUNNING) return;
    const std::lock_guard lock(mutex_);
    running_.insert(prefix);
    if (let_go_ != Clock::time_point{}) return;
    // While they crawl the machine is idle and a word is heard when it is said, but for the last one before we came.
    const std::chrono::nanoseconds age(dds::WallClock().now() - sample.source_timestamp_ns);
    last_words_[peer->cell] = {status.elapsed_s(), Clock::now() - age};
  }
  struct Word {
    double elapsed_s;
    Clock::time_point heard;
  };

  std::mutex mutex_;
  std::set<dds::GuidPrefix> running_;
  std::map<std::string, Word> last_words_;  // by cell, before they were let go
  Clock::time_point let_go_;
  dds::Participant participant_;
  dds::Reader<msg::SimStatus> statuses_;
  dds::Writer<msg::SimRequest> requests_;
};

}  // namespace

Measurement measureCells(const Case& one, int steps, Programs& programs) {
  const double crawl = kCrawl_steps_per_s * static_cast<double>(kStep_ns) * 1e-9;
  const std::string scenario = programs.write("cells.yaml", scenarioText(one.uses_force, one.standbys, steps, crawl));
  const std::string prefix = "bench-" + std::to_string(getpid()) + "-";
  const auto cellName = [&](int index) { return prefix + std::to_string(index); };
  std::vector<std::string> cells;
  cells.reserve(static_cast<std::size_t>(one.cells));
  for (int i = 0; i < one.cells; ++i) cells.push_back(cellName(i));
  Starter starter(programs.domain(), prefix + "*", cells);
  for (int i = 0; i < one.cells; ++i) {
    programs.start("baton", {"run", scenario, "--cell", cellName(i), "--domain", std::to_string(programs.domain()),
                             "--no-recording", "--open", "--json"});
  }
  programs.waitUntil([&] { return starter.areRunning(one.cells); });
  starter.letGo();
  const std::vector<std::string> printed = programs.finish();

  double steps_in_all = 0.0, longest_s = 0.0;  // some may end before others: what counts is when all have
  std::vector<double> p50s_us, p99s_us;
  for (int i = 0; i < one.cells; ++i) {
    const Json result = jsonIn(printed[static_cast<std::size_t>(i)]);
    p50s_us.push_back(result.at("timing").at("period_us").at("p50"));
    p99s_us.push_back(result.at("timing").at("period_us").at("p99"));
    steps_in_all += result.at("steps").get<double>();
    longest_s = std::max(longest_s, result.at("elapsed_s").get<double>() - starter.elapsedWhenLetGo(cellName(i)));
  }
  Measurement measured{.steps_per_s = steps_in_all / longest_s};
  measured.p50_us = median(p50s_us);
  measured.p99_us = median(p99s_us);
  return measured;
}

}  // namespace baton::bench
