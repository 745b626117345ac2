#include "result.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/swap_report.hpp"
#include "runtime/timing.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

const char* stateName(const RunResult& result) {
  if (result.startup_s < 0.0) return "not_started";
  if (result.exit_code == ExitCode::kInterrupted) return "stopped";
  return result.sim.state() == msg::SIM_STATE_FINISHED ? "finished" : "aborted";
}

/// What it did to the arm; null when that was not measured.
Json effectOf(const msg::SwapOutcome& swap, const std::vector<msg::SwapReport>& reports) {
  const auto found = std::find_if(reports.begin(), reports.end(), [&](const msg::SwapReport& one) {
    return one.take() == swap.take() && one.plan_id() == swap.plan_id() && one.at_step() == swap.at_step();
  });
  return found == reports.end() ? Json() : toJson(*found);
}

}  // namespace

void writeResult(const RunInfo& info, const Scenario& scenario, const RunResult& result) {
  const double sim_time_s = static_cast<double>(result.sim.time_ns()) * 1e-9;
  const double moved_s = static_cast<double>(result.sim.step() - result.sim.first_step()) * scenario.stepSeconds();
  Json json{{"run", info.run},
            {"cell", info.cell},
            {"domain", info.domain},
            {"scenario", scenario.name},
            {"scenario_file", info.scenario},
            {"folder", info.folder},
            {"state", stateName(result)},
            {"exit_code", static_cast<int>(result.exit_code)},
            {"reason", result.reason},
            {"step_ns", scenario.step_ns},
            {"first_step", result.sim.first_step()},
            {"steps", result.sim.step()},
            {"sim_time_s", sim_time_s},
            {"holder", result.sim.holder().c_str()},
            {"elapsed_s", result.sim.elapsed_s()},
            {"real_time_ratio", result.sim.elapsed_s() > 0.0 ? moved_s / result.sim.elapsed_s() : 0.0},
            {"startup_s", result.startup_s},
            {"missed_steps", result.sim.missed_steps()},
            {"timing", toJson(result.timing)},
            {"chain_hash", std::to_string(result.sim.chain_hash())}};
  if (info.recording.empty()) {
    json["recording"] = nullptr;
  } else {
    const std::string path = result.recorder.path().size() > 0 ? result.recorder.path().c_str() : info.recording;
    std::error_code ignored;
    const bool is_there = std::filesystem::exists(path, ignored);
    json["recording"] = Json{{"path", is_there ? Json(path) : Json()},    {"complete", result.recorder.complete()},
                             {"summary", result.recorder.text().c_str()}, {"messages", result.recorder.messages()},
                             {"bytes", result.recorder.bytes()},          {"lost", result.recorder.lost()}};
  }
  json["swaps"] = Json::array();
  for (const msg::SwapOutcome& swap : result.swaps) {
    Json one = toJson(swap);
    one["report"] = swap.done() ? effectOf(swap, result.reports) : Json();
    json["swaps"].push_back(std::move(one));
  }
  json["resident_kB"] = result.resident_kB;

  writeFile(std::filesystem::path(info.folder) / "result.json", toText(json) + '\n');
}

}  // namespace baton
