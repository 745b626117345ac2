#include "param_command.hpp"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "control/nearest_name.hpp"
#include "latest_by_name.hpp"
#include "run_commands.hpp"
#include "runtime/json.hpp"
#include "runtime/scenario.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

struct ListRequest {
  std::string cell = "lab";
  int domain = 0;
  std::string controller;  // empty: all
  bool json = false;
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
  std::printf("%s, law %s\n", controller.name().c_str(), controller.law().c_str());
  for (const msg::Parameter& one : controller.parameters()) {
    std::printf("  %-18s %-30s %-22s %-24s %s\n", one.name().c_str(), valueText(one).c_str(), one.unit().c_str(),
                rangeText(one).c_str(), one.doc().c_str());
  }
}

void list(const ListRequest& request) {
  CellClient client(CellClient::find(request.domain, request.cell));
  std::vector<std::string> expected =
      controllerNames(loadScenario(keptScenario(client.info()), keptRobot(client.info())));
  if (!request.controller.empty()) {
    if (std::find(expected.begin(), expected.end(), request.controller) == expected.end()) {
      throw UsageError(unknownName("controller", request.controller, expected));
    }
    expected = {request.controller};
  }
  const auto all = latestByName(client, dds::topics::kParameterStatus, expected);
  Json json = Json::array();
  for (const std::string& name : expected) {
    const auto found = all.find(name);
    if (found == all.end()) {
      if (!request.controller.empty()) throw UnavailableError(name + " says nothing; see `baton controllers`");
      if (!request.json) std::printf("%s says nothing\n", name.c_str());
      continue;
    }
    if (!request.json) {
      print(found->second);
      continue;
    }
    Json parameters = Json::array();
    for (const msg::Parameter& one : found->second.parameters()) parameters.push_back(toJson(one));
    json.push_back({{"name", name}, {"law", found->second.law().c_str()}, {"parameters", parameters}});
  }
  if (request.json) std::cout << toText(json) << '\n';
}

}  // namespace

void addParamCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("param", "the parameters of a run's controllers");
  command->require_subcommand(1);
  const auto request = std::make_shared<ListRequest>();
  CLI::App* list_command =
      command->add_subcommand("list", "what each controller runs with: value, unit, range, meaning");
  list_command->add_option("controller", request->controller, "one controller (default: all)");
  addCellOptions(*list_command, request->cell, request->domain);
  list_command->add_flag("--json", request->json, "print JSON");
  list_command->callback([=] { list(*request); });
}

}  // namespace baton
