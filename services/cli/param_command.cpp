#include "param_command.hpp"

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "cell_target.hpp"
#include "control/nearest_name.hpp"
#include "latest_by_name.hpp"
#include "messages/parameters.hpp"
#include "parameter_setting.hpp"
#include "run_commands.hpp"
#include "runtime/json.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario.hpp"
#include "runtime/service_options.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

struct ParamArguments {
  CellTarget target;
  std::string controller;             // list: empty for all
  std::vector<std::string> names;     // get
  std::vector<std::string> settings;  // set: NAME=VALUE
  std::uint64_t at_step = 0;
  std::optional<double> at_s;
};

std::string shown(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

std::string valueText(const msg::Parameter& parameter) {
  std::string text = parameter.word().c_str();
  for (const double value : parameter.numbers()) text += (text.empty() ? "" : " ") + shown(value);
  return text;
}

std::string rangeText(const msg::Parameter& parameter) {
  std::string text;
  for (const auto& choice : parameter.choices()) text += (text.empty() ? "" : " | ") + std::string(choice.c_str());
  if (std::isfinite(parameter.minimum())) text += ">= " + shown(parameter.minimum());
  if (std::isfinite(parameter.maximum())) text += (text.empty() ? "<= " : ", <= ") + shown(parameter.maximum());
  return text;
}

Json toJson(const msg::Parameter& parameter) {
  Json json{{"name", parameter.name().c_str()}, {"unit", parameter.unit().c_str()}, {"doc", parameter.doc().c_str()}};
  if (parameter.numbers().empty()) {
    json["value"] = parameter.word().c_str();
    json["choices"] = Json::array();
    for (const auto& choice : parameter.choices()) json["choices"].push_back(choice.c_str());
    return json;
  }
  json["value"] = parameter.numbers();
  if (std::isfinite(parameter.minimum())) json["minimum"] = parameter.minimum();
  if (std::isfinite(parameter.maximum())) json["maximum"] = parameter.maximum();
  return json;
}

void print(const msg::ParameterStatus& controller) {
  say("%s, law %s\n", controller.name().c_str(), controller.law().c_str());
  for (const msg::Parameter& one : controller.parameters()) {
    say("  %-18s %-30s %-22s %-24s %s\n", one.name().c_str(), valueText(one).c_str(), one.unit().c_str(),
        rangeText(one).c_str(), one.doc().c_str());
  }
}

/// The controllers of the run, or the one that is meant. Throws UsageError when there is none of that name.
std::vector<std::string> meantControllers(const CellClient& client, const std::string& controller) {
  std::vector<std::string> all = controllerNames(loadScenario(keptScenario(client.info()), keptRobot(client.info())));
  if (controller.empty()) return all;
  if (std::find(all.begin(), all.end(), controller) == all.end()) {
    throw UsageError(unknownName("controller", controller, all));
  }
  return {controller};
}

void list(const ParamArguments& request) {
  CellClient client(CellClient::find(request.target.domain, request.target.cell));
  const std::vector<std::string> expected = meantControllers(client, request.controller);
  const auto all = latestByName(client, dds::topics::kParameterStatus, expected);
  Json json = Json::array();
  for (const std::string& name : expected) {
    const auto found = all.find(name);
    if (found == all.end()) {
      if (!request.controller.empty()) throw UnavailableError(name + " says nothing; see `baton controllers`");
      if (!request.target.json) say("%s says nothing\n", name.c_str());
      continue;
    }
    if (!request.target.json) {
      print(found->second);
      continue;
    }
    Json parameters = Json::array();
    for (const msg::Parameter& one : found->second.parameters()) parameters.push_back(toJson(one));
    json.push_back({{"name", name}, {"law", found->second.law().c_str()}, {"parameters", parameters}});
  }
  if (request.target.json) sayText(toText(json) + '\n');
}

void get(const ParamArguments& request) {
  CellClient client(CellClient::find(request.target.domain, request.target.cell));
  const auto all = latestByName(client, dds::topics::kParameterStatus, meantControllers(client, request.controller));
  const auto found = all.find(request.controller);
  if (found == all.end()) throw UnavailableError(request.controller + " says nothing; see `baton controllers`");
  Json json = Json::object();
  for (const std::string& name : request.names) {
    std::vector<std::string> known;
    const msg::Parameter* parameter = nullptr;
    for (const msg::Parameter& one : found->second.parameters()) {
      known.emplace_back(one.name().c_str());
      if (known.back() == name) parameter = &one;
    }
    if (parameter == nullptr) throw UsageError(unknownName("parameter", name, known));
    if (request.target.json) {
      json[name] = toJson(*parameter).at("value");
    } else {
      const std::string label = request.names.size() > 1 ? name + " " : "";
      say("%s%s\n", label.c_str(), valueText(*parameter).c_str());
    }
  }
  if (request.target.json) sayText(toText(json) + '\n');
}

void set(const ParamArguments& request, ExitCode& exit_code) {
  msg::ParameterRequest message;
  for (const std::string& setting : request.settings) {
    if (message.values().size() == msg::MAX_PARAMETERS) {
      throw UsageError("expected at most " + std::to_string(msg::MAX_PARAMETERS) + " values at once");
    }
    const auto [name, value] = parseParameter(setting);
    message.values().push_back(toMessage(name, value));
  }
  CellClient client(CellClient::find(request.target.domain, request.target.cell));
  const std::string controller = meantControllers(client, request.controller).front();
  message.request_id(CellClient::newRequestId());
  message.controller(controller);
  message.at_step(request.at_s ? stepAt(client, *request.at_s) : request.at_step);
  const auto reply = client.ask<msg::ParameterRequest, msg::ParameterReply>(
      dds::topics::kParameterRequest, message, dds::topics::kParameterReply,
      [&](const msg::ParameterReply& one) { return one.request_id() == message.request_id(); }, controller);
  if (!reply) throw UnavailableError(controller + " did not answer; see `baton controllers`");
  exit_code = reply->accepted() ? ExitCode::kOk : ExitCode::kFailed;
  if (request.target.json) {
    sayText(toText(Json{{"accepted", reply->accepted()},
                        {"controller", controller},
                        {"at_step", reply->at_step()},
                        {"reason", reply->reason().c_str()}}) +
            '\n');
  } else if (reply->accepted()) {
    say("%s from step %llu on: %s\n", controller.c_str(), static_cast<unsigned long long>(reply->at_step()),
        toText(fromMessages(message.values())).c_str());
  } else {
    say("refused: %s; nothing is changed (`baton param list %s` tells what it has)\n", reply->reason().c_str(),
        controller.c_str());
  }
}

}  // namespace

void addParamCommand(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("param", "the parameters of a run's controllers");
  command->require_subcommand(1);
  const auto request = std::make_shared<ParamArguments>();
  const auto add = [&](const char* name, const char* help) {
    return addCellCommand(*command, request->target, name, help);
  };
  CLI::App* list_command = add("list", "what each controller runs with: value, unit, range, meaning");
  list_command->add_option("controller", request->controller, "one controller (default: all)");
  list_command->callback([=] { list(*request); });

  CLI::App* get_command = add("get", "values alone, for scripts");
  get_command->add_option("controller", request->controller, "whose")->required();
  get_command->add_option("name", request->names, "which parameters")->required();
  get_command->callback([=] { get(*request); });

  CLI::App* set_command = add("set", "change values at the start of a step: all of them or none");
  set_command->footer(
      "Values are written as in scenarios. The controller checks them and says from which step on it computes with\n"
      "them; a reset takes them back.\n"
      "  baton param set impedance kp=300\n"
      "  baton param set impedance 'kp=[300, 300, 100, 70, 70, 70]' form=no_force --at-time 2.5");
  set_command->add_option("controller", request->controller, "whose")->required();
  set_command->add_option("values", request->settings, "NAME=VALUE, once or more")->required();
  auto* at = set_command->add_option_function<std::uint64_t>(
      "--at", [request](const std::uint64_t& step) { request->at_step = stepToCome(step); },
      "the first step with them (default: as soon as possible)");
  addAtTime(*set_command, request->at_s, at);
  set_command->callback([=, &exit_code] { set(*request, exit_code); });
}

}  // namespace baton
