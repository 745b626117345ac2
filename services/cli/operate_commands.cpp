#include "operate_commands.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "cell_target.hpp"
#include "latest_by_name.hpp"
#include "messages/state_names.hpp"
#include "run_commands.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario.hpp"
#include "runtime/service_options.hpp"
#include "runtime/timing.hpp"
#include "time/pacer.hpp"
#include "timing_text.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;
using ull = unsigned long long;

/// Of a service without a status, after CellClient::kStatusPatience.
constexpr const char* kSilent = "said nothing for 5 s: stopped, gone, or without a processor";

void status(const CellTarget& target) {
  CellClient client(CellClient::find(target.domain, target.cell));
  const Scenario scenario = loadScenario(keptScenario(client.info()), keptRobot(client.info()));
  const msg::SimStatus sim = simStatus(client);
  const Json timing = baton::toJson(
      client.latest(dds::topics::kTimingStatus, CellClient::kStatusPatience).value_or(msg::TimingStatus{}));
  std::vector<std::string> expected = serviceNames(scenario);
  expected.emplace_back(kSupervisorName);
  const bool has_begun = sim.state() != msg::SIM_STATE_STARTING;  // before, the plant says nothing of the baton
  const auto baton =
      !has_begun ? msg::BatonStatus{}
                 : client.latest(dds::topics::kBatonStatus, CellClient::kStatusPatience).value_or(msg::BatonStatus{});
  for (const msg::BatonMember& member : baton.members()) {  // those that joined on the way, too
    if (std::ranges::find(expected, member.name().c_str()) == expected.end())
      expected.emplace_back(member.name().c_str());
  }
  if (client.info().recording.empty()) std::erase(expected, kRecorderName);
  const auto services = latestByName(client, dds::topics::kServiceStatus, expected);
  const double time_s = static_cast<double>(sim.time_ns()) * 1e-9;
  if (target.json) {
    Json json{{"run", client.info().run},
              {"cell", client.info().cell},
              {"scenario", client.info().scenario},
              {"state", toString(sim.state())},
              {"step", sim.step()},
              {"end_step", sim.end_step()},
              {"sim_time_s", time_s},
              {"elapsed_s", sim.elapsed_s()},
              {"rate", sim.rate()},
              {"holder", sim.holder().c_str()},
              {"waiting_for", sim.waiting_for().c_str()},
              {"missed_steps", sim.missed_steps()},
              {"timing", timing},
              {"recording", client.info().recording},
              {"services", Json::array()}};
    for (const auto& [name, service] : services) {
      json["services"].push_back({{"name", name},
                                  {"role", service.role().c_str()},
                                  {"state", toString(service.state())},
                                  {"pid", service.pid()},
                                  {"text", service.text().c_str()}});
    }
    for (const std::string& name : expected) {
      if (services.contains(name)) continue;
      json["services"].push_back(
          {{"name", name}, {"role", nullptr}, {"state", "silent"}, {"pid", nullptr}, {"text", kSilent}});
    }
    sayText(toText(json) + '\n');
    return;
  }
  say("run %s of %s in cell %s, domain %d\n", client.info().run.c_str(), client.info().scenario.c_str(),
      client.info().cell.c_str(), client.info().domain);
  say("%s at step %llu", toString(sim.state()), ull{sim.step()});
  if (sim.end_step() > 0) say(" of %llu", ull{sim.end_step()});
  say(", %.4f s of motion in %.2f s, %s%s, %s holds the baton\n", time_s, sim.elapsed_s(),
      sim.mode() == msg::SIM_MODE_REALTIME ? "realtime" : "lockstep",
      sim.rate() > 0.0 ? fmt::format(" at rate {:g}", sim.rate()).c_str() : " as fast as possible",
      sim.holder().size() > 0 ? sim.holder().c_str() : "the brake");
  if (const std::string text = timingText(timing); !text.empty()) say("%s\n", text.c_str());
  if (sim.waiting_for().size() > 0) say("waits for %s\n", sim.waiting_for().c_str());
  for (const auto& [name, service] : services) {
    say("  %-16s %-12s %-9s pid %-8d %s\n", name.c_str(), service.role().c_str(), toString(service.state()),
        static_cast<int>(service.pid()), service.text().c_str());
  }
  for (const std::string& name : expected) {
    if (!services.contains(name)) say("  %-16s %-12s %-9s %s\n", name.c_str(), "", "silent", kSilent);
  }
}

/// Waits until the run stands still again, at `goal` or wherever it was stopped; as long as it moves.
std::uint64_t stepReached(CellClient& client, std::uint64_t goal) {
  std::uint64_t step = simStatus(client).step();
  for (;;) {
    const std::uint64_t before = step;
    const auto hasStopped = [&](const std::vector<msg::SimStatus>& all) {
      step = all.empty() ? step : all.back().step();
      return !all.empty() && (step >= goal || all.back().state() != msg::SIM_STATE_RUNNING);
    };
    if (hasStopped(client.collect<msg::SimStatus>(dds::topics::kSimStatus, hasStopped))) return step;
    if (step == before) {
      throw UnavailableError("the run stands at step " + std::to_string(step) + " and does not reach " +
                             std::to_string(goal) + "; see `baton status`");
    }
  }
}

void sim(const CellTarget& target, const msg::SimRequest& what, const std::optional<double>& at_s,
         ExitCode& exit_code) {
  CellClient client(CellClient::find(target.domain, target.cell));
  msg::SimRequest request = what;
  if (at_s) request.at_step(stepAt(client, *at_s));
  request.request_id(CellClient::newRequestId());
  auto reply = client.ask<msg::SimRequest, msg::SimReply>(
      dds::topics::kSimRequest, request, dds::topics::kSimReply,
      [&](const msg::SimReply& one) { return one.request_id() == request.request_id(); }, kPlantName);
  if (!reply) throw UnavailableError("the plant did not answer; see `baton status`");
  exit_code = reply->accepted() ? ExitCode::kOk : ExitCode::kFailed;
  if (reply->accepted() && what.action() == msg::SIM_STEP) {
    const std::uint64_t most = std::numeric_limits<std::uint64_t>::max() - reply->step();
    reply->step(stepReached(client, reply->step() + std::min(what.steps(), most)));
  }
  if (target.json) {
    sayText(
        toText(Json{{"accepted", reply->accepted()}, {"step", reply->step()}, {"reason", reply->reason().c_str()}}) +
        '\n');
  } else if (reply->accepted()) {
    if (request.at_step() > 0) {
      say("asked at step %llu, for step %llu\n", ull{reply->step()}, ull{request.at_step()});
    } else {
      say("done at step %llu\n", ull{reply->step()});
    }
  } else {
    say("refused at step %llu: %s\n", ull{reply->step()}, reply->reason().c_str());
  }
}

void addSimCommands(CLI::App& app, const std::shared_ptr<CellTarget>& target, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("sim", "pause, resume, step, change the rate, stop");
  command->require_subcommand(1);
  const auto request = std::make_shared<msg::SimRequest>();
  const auto at_s = std::make_shared<std::optional<double>>();
  const auto add = [&](const char* name, const char* help, msg::SimAction action) {
    CLI::App* sub = addCellCommand(*command, *target, name, help);
    sub->callback([=, &exit_code] {
      request->action(action);
      sim(*target, *request, *at_s, exit_code);
    });
    return sub;
  };
  const auto addWhen = [=](CLI::App* sub) {
    auto* at = sub->add_option_function<std::uint64_t>(
        "--at", [request](const std::uint64_t& step) { request->at_step(stepToCome(step)); },
        "when this step opens, not here");
    addAtTime(*sub, *at_s, at);
  };
  addWhen(add("pause", "hold the run before its next step", msg::SIM_PAUSE));
  add("resume", "go on", msg::SIM_RESUME);
  addWhen(add("stop", "end the run here, in order", msg::SIM_STOP));
  add("reset", "back to the first step; the processes stay", msg::SIM_RESET);
  add("step", "run N steps, then pause", msg::SIM_STEP)
      ->add_option_function<std::uint64_t>(
          "n", [request](const std::uint64_t& n) { request->steps(n); }, "how many steps")
      ->required();
  add("rate", "simulated seconds per second, or max", msg::SIM_RATE)
      ->add_option_function<std::string>(
          "rate", [request](const std::string& text) { request->rate(parseRate("sim rate", text, kMaxRate)); },
          "X or max")
      ->required();
}

}  // namespace

void addOperateCommands(CLI::App& app, ExitCode& exit_code) {
  const auto target = std::make_shared<CellTarget>();
  addCellCommand(app, *target, "status", "how the run and its services stand")->callback([=] { status(*target); });
  addSimCommands(app, target, exit_code);
}

}  // namespace baton
