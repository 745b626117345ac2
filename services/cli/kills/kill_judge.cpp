#include "kills/kill_judge.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/reader.hpp"

namespace baton {
namespace {

double partOfLimit(double effort, double limit) {
  if (!std::isfinite(effort)) return std::numeric_limits<double>::infinity();
  return std::abs(effort) / limit;
}

/// Who takes over from a holder that fails.
std::string fallbackOf(const std::string& victim, const Scenario& scenario) {
  for (const std::string& name : scenario.baton.fallback) {
    if (name != victim) return name;
  }
  return "";
}

/// The plant may have been some steps ahead of the state that named the victim.
bool hadHandedOver(const KilledRun& run, const PlantRecord& record) {
  for (std::uint64_t step = run.step + 1; step <= run.step + kFence_steps && step < record.holders.size(); ++step) {
    if (record.lost_at && step > *record.lost_at) return false;
    if (record.holders[step] != run.service) return true;
  }
  return false;
}

std::string lostTheBaton(const KilledRun& run, const PlantRecord& record, const Scenario& scenario) {
  if (hadHandedOver(run, record)) return "";
  if (!record.lost_at) return run.service + " was not taken for failed";
  const std::uint64_t at = *record.lost_at;
  if (at + 1 >= record.holders.size()) return "the run ends with the failure";
  if (record.holders[at] != run.service) return fmt::format("step {} is not {}'s own", at, run.service);
  const std::string next = fallbackOf(run.service, scenario);
  if (record.holders[at + 1] != next) {
    return fmt::format("{} holds the baton after {}, not {}", record.holders[at + 1], run.service, next);
  }
  const bool is_back = std::find(record.holders.begin() + static_cast<std::ptrdiff_t>(at) + 1, record.holders.end(),
                                 run.service) != record.holders.end();
  return is_back ? run.service + " holds the baton again by itself" : "";
}

}  // namespace

PlantRecord readPlantRecord(const std::filesystem::path& recording, const Scenario& scenario,
                            const std::string& victim) {
  PlantRecord record;
  const mcap::Reader reader(recording);
  reader.forEachMessage(
      {.topics = {dds::topics::kPlantState.name, dds::topics::kDecision.name},
       .order = mcap::MessageFilter::Order::kFile},
      [&](const mcap::MessageView& view) {
        msg::Decision decision;
        msg::PlantState state;
        if (view.channel->topic == dds::topics::kDecision.name) {
          const bool is_loss = dds::decode(view.data, decision) && decision.cause() == msg::DECISION_FAILED;
          if (is_loss && decision.controller() == victim.c_str() && !record.lost_at) record.lost_at = decision.step();
          return;
        }
        if (!dds::decode(view.data, state)) return;
        record.holders.emplace_back(state.holder().c_str());
        for (std::size_t i = 0; i < state.applied_effort().size(); ++i) {
          const double part = partOfLimit(state.applied_effort()[i], scenario.robot.joints.at(i).effort_limit);
          record.largest_torque = std::max(record.largest_torque, part);
        }
      });
  return record;
}

std::string objectionTo(const Kill& kill, const KilledRun& run, const PlantRecord& record, const Scenario& scenario,
                        const std::string& undisturbed_hash) {
  if (run.service.empty()) return fmt::format("the run ended before step {}, at which one was to be killed", kill.step);
  if (record.largest_torque > 1.0) return "a torque above its limit, or not finite";
  const std::string state = run.result.at("state"), reason = run.result.at("reason");
  const bool is_named = reason.find(run.service) != std::string::npos;
  const bool is_same = run.result.at("chain_hash") == undisturbed_hash;
  const auto expectState = [&](const char* expected) {
    return state == expected ? "" : fmt::format("{} where {} was expected: {}", state, expected, reason);
  };
  const auto expectSame = [&] { return is_same ? "" : "other bytes than undisturbed"; };
  const auto expectNamed = [&] { return is_named ? "" : "the reason does not name it: " + reason; };
  const auto first = [](std::initializer_list<std::string> objections) {
    const auto found = std::find_if(objections.begin(), objections.end(), [](const auto& one) { return !one.empty(); });
    return found == objections.end() ? std::string() : *found;
  };

  if (kill.of.way == Way::kRestarted) return first({expectState("finished"), expectNamed(), expectSame()});
  switch (kill.of.victim) {
    case Victim::kHolder: {
      const bool is_noticed = kill.of.way == Way::kKilled || !hadHandedOver(run, record);
      return first({expectState("finished"), is_noticed ? expectNamed() : "", lostTheBaton(run, record, scenario)});
    }
    case Victim::kStandby: {
      // Nobody waits for one that stands by, but for the handover to it.
      const bool is_awaited = run.service == scenario.swaps.front().to;
      const std::string other = is_awaited && !is_same && !record.lost_at ? "other bytes, and it was not lost" : "";
      return first({expectState("finished"), kill.of.way == Way::kKilled ? expectNamed() : "",
                    is_awaited ? other : expectSame()});
    }
    case Victim::kTrajectory:
      // Whoever holds the baton has nothing to follow and falls silent, one after the other, and the brake holds.
      if (kill.of.way == Way::kStopped) {
        const bool braked = std::find(record.holders.begin(), record.holders.end(), "") != record.holders.end();
        return first({expectState("finished"), braked ? "" : "the brake never held"});
      }
      [[fallthrough]];
    case Victim::kEnvironment: return first({expectState("aborted"), expectNamed()});
    case Victim::kRecorder:
      if (kill.of.way == Way::kKilled && run.exit_code == ExitCode::kOk) return "its end counts as a success";
      return first({state == "finished" ? "it went on to its end" : "", expectNamed()});
  }
  return "";
}

}  // namespace baton
