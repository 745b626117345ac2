#include "laws_command.hpp"

#include <cmath>
#include <cstdio>
#include <memory>

#include "control/law.hpp"
#include "runtime/json.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

const char* nameOf(ParameterSize size) {
  switch (size) {
    case ParameterSize::kScalar: return "number";
    case ParameterSize::kPerJoint: return "per joint";
    case ParameterSize::kThree: return "x y z";
    case ParameterSize::kSix: return "x y z, rx ry rz";
    case ParameterSize::kChoice: return "word";
  }
  return "?";
}

Json toJson(const ParameterSpec& spec) {
  Json json{{"name", spec.name}, {"unit", spec.unit}, {"size", nameOf(spec.size)}, {"doc", spec.doc}};
  if (spec.size == ParameterSize::kChoice) {
    json["choices"] = spec.choices;
    return json;
  }
  json["default"] = spec.default_numbers;
  if (std::isfinite(spec.minimum)) json["minimum"] = spec.minimum;
  if (std::isfinite(spec.maximum)) json["maximum"] = spec.maximum;
  return json;
}

std::string defaultText(const ParameterSpec& spec) {
  std::string text;
  for (const std::string& word : spec.choices) text += (text.empty() ? "" : " | ") + word;
  for (const double value : spec.default_numbers) {
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), "%s%g", text.empty() ? "" : " ", value);
    text += number.data();
  }
  return text;
}

void print(const LawInfo& law, bool with_parameters) {
  say("%-30s %s%s\n", law.name.c_str(), law.summary.c_str(), law.requires_contact ? " (in contact only)" : "");
  if (!with_parameters) return;
  for (const ParameterSpec& spec : law.parameters) {
    say("  %-26s %-16s %-22s %s%s%s\n", spec.name.c_str(), nameOf(spec.size), defaultText(spec).c_str(),
        spec.doc.c_str(), spec.unit.empty() ? "" : ", ", spec.unit.c_str());
  }
}

}  // namespace

void addLawsCommand(CLI::App& app) {
  const auto name = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  CLI::App* command =
      app.add_subcommand("laws", "the laws a controller can run; with a name, its parameters and defaults");
  command->add_option("name", *name, "one law");
  command->add_flag("--json", *json, "print JSON, parameters included");
  command->callback([=] {
    std::vector<LawInfo> laws = name->empty() ? allLaws() : std::vector<LawInfo>{findLaw(*name)};
    if (!*json) {
      for (const LawInfo& law : laws) print(law, !name->empty());
      return;
    }
    Json list = Json::array();
    for (const LawInfo& law : laws) {
      Json parameters = Json::array();
      for (const ParameterSpec& spec : law.parameters) parameters.push_back(toJson(spec));
      list.push_back({{"name", law.name},
                      {"summary", law.summary},
                      {"uses_force", law.uses_force},
                      {"requires_contact", law.requires_contact},
                      {"parameters", parameters}});
    }
    sayText(toText(list) + '\n');
  });
}

}  // namespace baton
