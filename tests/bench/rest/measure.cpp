#include "measure.hpp"

#include <unistd.h>

#include <charconv>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <thread>

#include "dds/process.hpp"
#include "runtime/cell.hpp"
#include "runtime/paths.hpp"
#include "scenario.hpp"

namespace baton::bench {
namespace {
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kSteps = 200;
constexpr int kOthers = 2;  // controllers that stand by

struct Usage {
  int processes = 0;
  double cpu_s = 0.0;
};

/// Of these processes and all that descend from them.
Usage usageBelow(const std::set<int>& ancestors) {
  std::map<int, dds::ProcessFacts> all;
  for (const fs::path& path : listFolder("/proc")) {
    const std::string name = path.filename().string();
    int pid = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), pid).ec != std::errc()) continue;
    if (const auto facts = dds::factsOf(pid)) all[pid] = *facts;  // else it has ended meanwhile
  }
  Usage usage;
  for (const auto& [pid, process] : all) {
    int ancestor = pid;
    for (auto found = all.find(pid); !ancestors.contains(ancestor) && found != all.end(); found = all.find(ancestor)) {
      ancestor = found->second.parent;
    }
    if (!ancestors.contains(ancestor)) continue;
    ++usage.processes;
    usage.cpu_s += static_cast<double>(process.cpu_ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }
  return usage;
}

/// Of the run in this cell, when it is over.
std::optional<double> startupOf(const std::string& cell) {
  for (const fs::path& run : listFolder(stateFolder() / "runs")) {
    if (!fs::exists(run / "result.json")) continue;
    const nlohmann::json result = nlohmann::json::parse(readFile(run / "result.json"));
    if (result.at("cell") == cell) return result.at("startup_s").get<double>();
  }
  return std::nullopt;
}

std::set<int> supervisors() {
  std::set<int> pids;
  for (const RunInfo& run : activeRuns()) pids.insert(run.supervisor_pid);
  return pids;
}

/// The cells go on by themselves, whatever becomes of the measurement.
struct Ended {
  ~Ended() {
    for (const int pid : supervisors()) kill(pid, SIGTERM);
    for (int waited = 0; waited < 300 && !supervisors().empty(); ++waited) usleep(100'000);
  }
};

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

}  // namespace

RestCost measureRest(int cells, double seconds, Programs& programs) {
  const std::string prefix = "rest-" + std::to_string(getpid()) + "-", domain = std::to_string(programs.domain());
  const std::string resting = programs.write("resting.yaml", scenarioText(true, kOthers, kSteps));
  const std::string beside = programs.write("beside.yaml", scenarioText(true, 0, kSteps));
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(cells));
  for (int i = 0; i < cells; ++i) names.push_back(prefix + std::to_string(i));
  RestCost cost;
  const Ended ended;
  const Clock::time_point launched = Clock::now();
  for (const std::string& name : names) {
    programs.start("baton", {"up", resting, "--cell", name, "--domain", domain, "--no-recording", "--paused"});
  }
  programs.waitUntil([&] { return !programs.anyRunning(); });  // each ends when its cell is paused
  cost.started_s = since(launched);
  const std::set<int> pids = supervisors();
  const Usage before = usageBelow(pids);
  const Clock::time_point begin = Clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const double elapsed_s = since(begin);
  const Usage after = usageBelow(pids);
  cost.processes = after.processes;
  cost.cpu_cores = (after.cpu_s - before.cpu_s) / elapsed_s;

  const std::string other = prefix + "beside";
  programs.start("baton", {"run", beside, "--cell", other, "--domain", domain, "--no-recording"});
  programs.waitUntil([&] {
    const std::optional<double> startup_s = startupOf(other);
    cost.beside_startup_s = startup_s.value_or(0.0);
    return startup_s.has_value();
  });
  return cost;
}

}  // namespace baton::bench
