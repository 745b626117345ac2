#include "cell_client.hpp"

#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>

#include "runtime/paths.hpp"
#include "runtime/say.hpp"

namespace baton {

CellClient::CellClient(const RunInfo& info)
    : info_(info),
      participant_(operatorOf(info),
                   [this](const dds::Peer&) {
                     const std::lock_guard lock(mutex_);
                     changed_.notify_all();
                   }),
      admission_(participant_, false, sayWarning) {}

namespace {
/// How the cell's last run ended, as a sentence; empty when there was none.
std::string lastRunOf(int domain, const std::string& cell) {
  std::string newest;
  std::string sentence;
  for (const std::filesystem::path& run : listFolder(stateFolder() / "runs")) {
    const std::string name = run.filename().string();
    if (name < newest) continue;  // they sort by time
    try {
      const nlohmann::json result = nlohmann::json::parse(readFile(run / "result.json"));
      if (result.at("cell") != cell || result.at("domain") != domain) continue;
      newest = name;
      sentence = ". Its last run, " + name + ", is over: " + result.at("state").get<std::string>() + " (" +
                 (run / "result.json").string() + ")";
    } catch (const std::exception&) {
      continue;  // it left no result
    }
  }
  return sentence;
}
}  // namespace

RunInfo CellClient::find(int domain, const std::string& cell) {
  if (const std::optional<RunInfo> run = activeRun(domain, cell)) return *run;
  std::string others;
  for (const RunInfo& run : activeRuns()) {
    others += (others.empty() ? "" : ", ") + ("--cell " + run.cell + " --domain " + std::to_string(run.domain));
  }
  throw UnavailableError("nothing runs in cell " + cell + " of domain " + std::to_string(domain) +
                         (others.empty() ? ": start a scenario with `baton up SCENARIO`" : "; there is: " + others) +
                         lastRunOf(domain, cell));
}

std::uint64_t CellClient::newRequestId() {
  std::random_device device;
  return (std::uint64_t{device()} << 32 | device()) | 1;  // 0 means planned by the scenario
}

bool CellClient::isMatchedWith(const std::set<dds::GuidPrefix>& matched, const std::string& service) const {
  for (const dds::GuidPrefix& prefix : matched) {
    if (const auto peer = participant_.member(prefix); peer && peer->service == service) return true;
  }
  return false;
}

}  // namespace baton
