#include "baton_commands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include "base/plural.hpp"
#include "cell_target.hpp"
#include "latest_by_name.hpp"
#include "messages/state_names.hpp"
#include "run_commands.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario.hpp"
#include "runtime/swap_report.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;
using ull = unsigned long long;

std::string numbersText(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%s%.4f", text.empty() ? "" : " ", number);
    text += digits.data();
  }
  return text;
}

Json numbersOrNull(const std::vector<double>& numbers) { return numbers.empty() ? Json() : Json(numbers); }

// --- controllers

/// What would come of a handover to each of them now, by its name. Nothing of it happens.
std::map<std::string, msg::SwapOutcome> forecasts(CellClient& client, const std::vector<std::string>& names) {
  std::vector<msg::SwapRequest> requests;
  for (const std::string& name : names) {
    msg::SwapRequest& request = requests.emplace_back();
    request.request_id(CellClient::newRequestId());
    request.target(name);
    request.dry_run(true);
    request.blend_ns(-1);
  }
  const auto belongs = [&](const msg::SwapOutcome& outcome) {
    return std::any_of(requests.begin(), requests.end(),
                       [&](const msg::SwapRequest& one) { return one.request_id() == outcome.request_id(); });
  };
  std::map<std::string, msg::SwapOutcome> found;
  for (const msg::SwapOutcome& outcome :
       client.askAll<msg::SwapRequest, msg::SwapOutcome>(dds::topics::kSwapRequest, requests, dds::topics::kSwapOutcome,
                                                         belongs, kPlantName, CellClient::kStatusPatience)) {
    found[outcome.incoming().c_str()] = outcome;
  }
  return found;
}

struct ControllerView {
  const ControllerConfig& config;
  std::optional<msg::ControllerStatus> status;  // nothing: it is silent
  std::optional<msg::SwapOutcome> forecast;     // nothing: it holds the baton, or nobody answered
  std::optional<msg::BatonMember> member;
  [[nodiscard]] std::string state() const {
    if (member && member->failed()) return "failed";
    return status ? toString(status->state()) : "silent";
  }
  [[nodiscard]] bool wasRefused() const { return member && member->refusal().size() > 0; }
};

Json toJson(const ControllerView& view) {
  Json json{{"name", view.config.name}, {"law", view.config.law}, {"state", view.state()}};
  if (view.status) {
    json["step"] = view.status->step();
    json["uses_force"] = view.status->uses_force();
    json["effort"] = view.status->effort();
    json["effort_gap"] = view.status->effort_gap();
    json["text"] = view.status->text().c_str();
  }
  json["forecast"] = nullptr;
  if (view.forecast) {
    json["forecast"] = {{"feasible", view.forecast->feasible()},
                        {"step", view.forecast->forecast_step()},
                        {"effort_step", numbersOrNull(view.forecast->forecast_effort_step())},
                        {"reason", view.forecast->reason().c_str()}};
  }
  json["last_refusal"] = nullptr;
  if (view.wasRefused()) {
    json["last_refusal"] = {{"step", view.member->refused_at_step()}, {"reason", view.member->refusal().c_str()}};
  }
  return json;
}

void print(const ControllerView& view) {
  const std::string effort = view.status ? numbersText(view.status->effort()) : "";
  std::string forecast;
  if (view.forecast) {
    forecast = numbersText(view.forecast->forecast_effort_step());
    if (!view.forecast->feasible())
      forecast += (forecast.empty() ? "no: " : "  no: ") + std::string(view.forecast->reason().c_str());
  }
  say("%-16s %-28s %-9s %10llu  %-32s %s\n", view.config.name.c_str(), view.config.law.c_str(), view.state().c_str(),
      ull{view.status ? view.status->step() : 0}, effort.c_str(), forecast.c_str());
  if (view.status && view.status->text().size() > 0) say("%18s%s\n", "", view.status->text().c_str());
  if (view.wasRefused()) {
    say("%18srefused at step %llu: %s\n", "", ull{view.member->refused_at_step()}, view.member->refusal().c_str());
  }
}

void controllers(const CellTarget& target) {
  CellClient client(CellClient::find(target.domain, target.cell));
  const Scenario scenario = loadScenario(keptScenario(client.info()), keptRobot(client.info()));
  std::vector<std::string> alive = controllerNames(scenario);
  for (const auto& [name, service] : latestByName(client, dds::topics::kServiceStatus, alive)) {
    if (service.state() == msg::SERVICE_FAILED) std::erase(alive, name);  // it will not speak any more
  }
  const auto statuses = latestByName(client, dds::topics::kControllerStatus, alive);
  const msg::BatonStatus baton =
      client.latest(dds::topics::kBatonStatus, CellClient::kStatusPatience).value_or(msg::BatonStatus{});
  std::vector<std::string> others = controllerNames(scenario);
  std::erase(others, std::string(baton.holder().c_str()));
  const bool has_begun = baton.members().size() > 0;
  const auto forecast = has_begun ? forecasts(client, others) : std::map<std::string, msg::SwapOutcome>{};

  Json json = Json::array();
  if (!target.json) {
    say("%-16s %-28s %-9s %10s  %-32s %s\n", "name", "law", "state", "step", "effort [N m or N]",
        "a handover now would change it by");
  }
  for (const ControllerConfig& config : scenario.controllers) {
    ControllerView view{config, {}, {}, {}};
    if (const auto found = statuses.find(config.name); found != statuses.end()) view.status = found->second;
    if (const auto found = forecast.find(config.name); found != forecast.end()) view.forecast = found->second;
    for (const msg::BatonMember& member : baton.members()) {
      if (config.name == member.name().c_str()) view.member = member;
    }
    if (target.json) {
      json.push_back(toJson(view));
    } else {
      print(view);
    }
  }
  if (target.json) sayText(toText(json) + '\n');
}

// --- swap

struct SwapWish {
  std::string target;
  std::uint64_t at_step = 0;  // 0: as soon as the margin allows
  std::optional<double> at_s;
  std::optional<double> blend_ms;
  bool force = false;
  bool hard = false;
  bool dry_run = false;
};

msg::SwapRequest requestFor(const SwapWish& wish, CellClient& client) {
  if (wish.target.size() >= msg::MAX_NAME) throw UsageError("controller names have at most 31 characters");
  msg::SwapRequest request;
  request.request_id(CellClient::newRequestId());
  request.target(wish.target);
  request.at_step(wish.at_s ? stepAt(client, *wish.at_s) : wish.at_step);
  request.force(wish.force);
  request.hard(wish.hard);
  request.dry_run(wish.dry_run);
  request.blend_ns(wish.blend_ms ? std::llround(*wish.blend_ms * 1e6) : -1);
  return request;
}

/// What the plant measures until the blend is over; nothing when the run does not get there soon.
std::optional<msg::SwapReport> reportOn(CellClient& client, const msg::SwapOutcome& outcome) {
  const auto isIt = [&](const msg::SwapReport& one) {
    return one.plan_id() == outcome.plan_id() && one.take() == outcome.take();
  };
  std::optional<msg::SwapReport> report;
  client.collect<msg::SwapReport>(
      dds::topics::kSwapReport,
      [&](const std::vector<msg::SwapReport>& all) {
        const auto found = std::find_if(all.begin(), all.end(), isIt);
        if (found != all.end()) report = *found;
        return report.has_value();
      },
      CellClient::kStatusPatience);
  return report;
}

/// From the plan to its first step, in real time; nothing when the run was held in between.
std::optional<double> delayOf(CellClient& client, const msg::SwapOutcome& outcome) {
  std::optional<double> delay_us;
  client.collect<msg::TimingStatus>(
      dds::topics::kTimingStatus,
      [&](const std::vector<msg::TimingStatus>& all) {
        if (all.empty() || all.back().last_handover_plan() < outcome.plan_id()) return false;
        if (all.back().last_handover_plan() == outcome.plan_id()) delay_us = all.back().last_handover_us();
        return true;
      },
      CellClient::kRecorderPatience);
  return delay_us;
}

void printDone(const msg::SwapOutcome& outcome, const std::optional<msg::SwapReport>& report,
               const std::optional<double>& delay_us) {
  say("%s holds the baton since step %llu, asked at step %llu", outcome.incoming().c_str(), ull{outcome.at_step()},
      ull{outcome.decided_at_step()});
  if (delay_us) say(", %.3f ms later", *delay_us * 1e-3);
  say("\n%-16s %s [N m or N] in its forecast for step %llu\n", "torques apart",
      numbersText(outcome.forecast_effort_step()).c_str(), ull{outcome.forecast_step()});
  const std::string fades =
      outcome.blend_steps() > 0 ? "fades over " + counted(outcome.blend_steps(), "step") : "at once";
  say("%-16s %s, %s\n", "", numbersText(outcome.raw_effort_step()).c_str(), fades.c_str());
  say("%-16s %s from one step to the next\n", "the joints felt", numbersText(outcome.applied_effort_step()).c_str());
  if (!report) {
    say("what it does to the arm is told by `swap_report` once the blend is over\n");
    return;
  }
  say("%-16s %s [N m/s or N/s], %llu times above the limit, in %llu steps\n", "fastest change",
      numbersText(report->max_effort_rate()).c_str(), ull{report->rate_limit_hits()}, ull{report->steps()});
  say("%-16s moved by at most %.4g N\n%-16s %.4g J from the blend\n", "contact force", report->peak_force_deviation(),
      "energy", report->blend_energy());
}

Json toJson(const msg::SwapOutcome& outcome, const std::optional<msg::SwapReport>& report,
            const std::optional<double>& delay_us) {
  return {{"done", outcome.done()},
          {"dry_run", outcome.dry_run()},
          {"feasible", outcome.dry_run() ? Json(outcome.feasible()) : Json()},
          {"outgoing", outcome.outgoing().c_str()},
          {"incoming", outcome.incoming().c_str()},
          {"decided_at_step", outcome.decided_at_step()},
          {"forecast_step", outcome.forecast_step()},
          {"at_step", outcome.at_step()},
          {"hard", outcome.hard()},
          {"blend_steps", outcome.blend_steps()},
          {"forecast_effort_step", numbersOrNull(outcome.forecast_effort_step())},
          {"raw_effort_step", outcome.raw_effort_step()},
          {"applied_effort_step", outcome.applied_effort_step()},
          {"delay_ms", delay_us ? Json(*delay_us * 1e-3) : Json()},
          {"reason", outcome.reason().c_str()},
          {"report", report ? baton::toJson(*report) : Json()}};
}

/// Throws UnavailableError.
[[noreturn]] void sayWhyNothingCame(CellClient& client, std::uint64_t at_step) {
  const msg::SimStatus sim = simStatus(client);
  if (sim.state() == msg::SIM_STATE_PAUSED) {
    throw UnavailableError(
        "asked, but the run is paused: the handover takes place once it goes on (`baton sim resume`)");
  }
  const std::string waits_for = sim.waiting_for().c_str();
  throw UnavailableError(
      "no outcome yet: the run stands at step " + std::to_string(sim.step()) + " and " +
      (at_step > sim.step()
           ? "the handover is for step " + std::to_string(at_step)
           : "waits for " + (waits_for.empty() ? "the next step; see `baton controllers`" : waits_for)));
}

void swap(const CellTarget& target, const SwapWish& wish, ExitCode& exit_code) {
  CellClient client(CellClient::find(target.domain, target.cell));
  const msg::SwapRequest request = requestFor(wish, client);
  const bool is_paused = simStatus(client).state() == msg::SIM_STATE_PAUSED;
  const auto outcome = client.ask<msg::SwapRequest, msg::SwapOutcome>(
      dds::topics::kSwapRequest, request, dds::topics::kSwapOutcome,
      [&](const msg::SwapOutcome& one) { return one.request_id() == request.request_id(); }, kPlantName,
      // In a pause only a refusal comes.
      is_paused && !wish.dry_run ? CellClient::kRecorderPatience : CellClient::kPatience);
  if (!outcome) sayWhyNothingCame(client, request.at_step());
  exit_code = outcome->done() || outcome->feasible() ? ExitCode::kOk : ExitCode::kFailed;
  std::optional<msg::SwapReport> report;
  std::optional<double> delay_us;
  if (outcome->done()) {
    report = reportOn(client, *outcome);
    delay_us = delayOf(client, *outcome);
  }
  if (target.json) {
    sayText(toText(toJson(*outcome, report, delay_us)) + '\n');
  } else if (outcome->done()) {
    printDone(*outcome, report, delay_us);
  } else if (outcome->feasible()) {
    say("nothing speaks against it: at step %llu, with the torques of step %llu, a handover from %s to %s\n"
        "would change them by %s [N m or N]\n",
        ull{outcome->at_step()}, ull{outcome->forecast_step()}, outcome->outgoing().c_str(),
        outcome->incoming().c_str(), numbersText(outcome->forecast_effort_step()).c_str());
  } else {
    say("%s: %s\n", outcome->dry_run() ? "it would be refused" : "refused", outcome->reason().c_str());
  }
}

}  // namespace

void addBatonCommands(CLI::App& app, ExitCode& exit_code) {
  const auto target = std::make_shared<CellTarget>();
  addCellCommand(app, *target, "controllers", "every controller: law, state, what a handover to it would change")
      ->callback([=] { controllers(*target); });

  const auto wish = std::make_shared<SwapWish>();
  CLI::App* command = addCellCommand(app, *target, "swap", "hand the baton to another controller");
  command->add_option("name", wish->target, "the controller that takes over")->required();
  CLI::Option* at = command->add_option_function<std::uint64_t>(
      "--at", [wish](const std::uint64_t& step) { wish->at_step = stepToCome(step); },
      "step at which it takes over (default: as soon as the margin allows)");
  addAtTime(*command, wish->at_s, at);
  CLI::Option* blend =
      command->add_option("--blend", wish->blend_ms, "ms over which the difference fades (default: the scenario's)")
          ->check(between(0.0, kMaxBlend_s * 1e3));
  command->add_flag("--hard", wish->hard, "without help: no blend, and the law starts anew instead of taking over")
      ->excludes(blend);
  command->add_flag("--force", wish->force, "even if the forecast jump is above the scenario's limit");
  command->add_flag("--dry-run", wish->dry_run, "only tell what would come of it now");
  command->callback([=, &exit_code] { swap(*target, *wish, exit_code); });
}

}  // namespace baton
