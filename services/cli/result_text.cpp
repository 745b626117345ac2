// How a finished run is told to a person.
#include <cmath>
#include <filesystem>

#include "run_session.hpp"
#include "runtime/say.hpp"
#include "timing_text.hpp"

namespace baton {
namespace {

double largest(const nlohmann::ordered_json& numbers) {
  double result = 0.0;
  for (const auto& number : numbers) result = std::max(result, std::abs(number.get<double>()));
  return result;
}

void printSwap(const nlohmann::ordered_json& swap) {
  const std::string from = swap.at("outgoing").get<std::string>();
  const std::string to = swap.at("incoming").get<std::string>();
  const std::string reason = swap.at("reason").get<std::string>();
  say("  step %6llu  %s -> %s", static_cast<unsigned long long>(swap.at("at_step")),
      from.empty() ? "(brake)" : from.c_str(), to.empty() ? "(brake)" : to.c_str());
  if (!swap.at("done").get<bool>()) {
    say(": refused, %s\n", reason.c_str());
    return;
  }
  say(": torques %.2g apart, the joints felt a change of %.2g", largest(swap.at("raw_effort_step")),
      largest(swap.at("applied_effort_step")));
  if (const auto& report = swap.at("report"); !report.is_null() && report.at("rate_limit_hits") > 0) {
    say(", %llu times faster than max_effort_rate", static_cast<unsigned long long>(report.at("rate_limit_hits")));
  }
  say("%s%s\n", reason.empty() ? "" : "; ", reason.c_str());
}

void printRecording(const nlohmann::ordered_json& recording) {
  const std::string summary = recording.at("summary").get<std::string>();
  if (recording.at("path").is_null()) {
    say("recording   none%s\n", summary.empty() ? "" : (": " + summary).c_str());
    return;
  }
  say("recording   %s\n            %.2f MB, %llu messages, %s\n", recording.at("path").get<std::string>().c_str(),
      recording.at("bytes").get<double>() / 1e6, static_cast<unsigned long long>(recording.at("messages")),
      summary.c_str());
}

}  // namespace

void printResult(const nlohmann::ordered_json& result) {
  const double elapsed_s = result.at("elapsed_s");
  say("%s: %s", result.at("scenario").get<std::string>().c_str(), result.at("state").get<std::string>().c_str());
  if (const std::string reason = result.at("reason"); !reason.empty()) say(" (%s)", reason.c_str());
  say("\n");
  if (result.at("startup_s").get<double>() >= 0.0) {
    double motion_s = result.at("sim_time_s");
    if (const auto first = result.value("first_step", std::uint64_t{0}); first > 0)  // it went on from there
      motion_s -= static_cast<double>(first) * result.at("step_ns").get<double>() * 1e-9;
    say("steps       %llu, %.6g s of motion in %.2f s: %.2f x real time, started in %.2f s\n",
        static_cast<unsigned long long>(result.at("steps")), motion_s, elapsed_s,
        result.at("real_time_ratio").get<double>(), result.at("startup_s").get<double>());
  }
  say("hash        %s: runs with the same one have the same bytes, step by step\n",
      result.at("chain_hash").get<std::string>().c_str());
  if (const std::uint64_t missed = result.at("missed_steps"); missed > 0) {
    say("missed      %llu steps had to use an old torque\n", static_cast<unsigned long long>(missed));
  }
  // In one process there is no clock to keep.
  if (const auto timing = result.find("timing"); timing != result.end() && !timing->at("jitter_us").is_null()) {
    say("timing      %s\n", timingText(*timing).c_str());
  }
  if (!result.at("swaps").empty()) say("handovers   [N m or N, largest over the joints]\n");
  for (const auto& swap : result.at("swaps")) {
    const bool has_come = swap.at("done").get<bool>() || swap.at("at_step") < result.at("steps");
    if (has_come) printSwap(swap);
  }
  if (const auto& recording = result.at("recording"); !recording.is_null()) printRecording(recording);
  if (result.contains("folder")) say("logs        %s\n", result.at("folder").get<std::string>().c_str());
}

}  // namespace baton
