#include "runtime/scenario_edit.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>

#include "base/error.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

std::vector<std::string> partsOf(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream stream(path);
  for (std::string part; std::getline(stream, part, '.');) {
    if (part.empty()) throw UsageError("--set " + path + ": expected names and places between dots");
    parts.push_back(part);
  }
  if (parts.empty()) throw UsageError("--set: expected a path before '='");
  return parts;
}

/// The entry of a list at a place, or of a name.
YAML::Node entryOf(const YAML::Node& list, const std::string& part, const std::string& path) {
  std::string known;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const YAML::Node entry = list[i];
    const YAML::Node name = entry.IsMap() ? entry["name"] : YAML::Node(YAML::NodeType::Undefined);
    const bool has_name = name.IsDefined() && name.IsScalar();
    if (part == std::to_string(i) || (has_name && name.Scalar() == part)) return entry;
    known += (known.empty() ? "" : ", ") + (has_name ? name.Scalar() : std::to_string(i));
  }
  if (known.empty()) throw UsageError("--set " + path + ": the list has no entries, found '" + part + "'");
  throw UsageError("--set " + path + ": expected one of " + known + ", found '" + part + "'");
}

void set(YAML::Node node, const std::vector<std::string>& parts, std::size_t at, const YAML::Node& value,
         const std::string& path) {
  const std::string& part = parts[at];
  const bool is_last = at + 1 == parts.size();
  if (node.IsSequence()) {
    YAML::Node entry = entryOf(node, part, path);
    if (is_last) {
      entry = value;  // yaml-cpp: assigns to the entry in the list
    } else {
      set(entry, parts, at + 1, value, path);
    }
    return;
  }
  if (!node.IsMap()) throw UsageError("--set " + path + ": nothing can stand below '" + parts[at - 1] + "', a value");
  if (is_last) {
    node[part] = value;
    return;
  }
  if (!node[part].IsDefined() || node[part].IsNull()) node[part] = YAML::Node(YAML::NodeType::Map);
  set(node[part], parts, at + 1, value, path);
}

std::string textOf(const YAML::Node& root) {
  YAML::Emitter emitter;
  emitter.SetDoublePrecision(17);
  emitter << root;
  return std::string(emitter.c_str()) + "\n";
}

}  // namespace

ScenarioSetting parseSetting(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw UsageError("--set: expected path=value, such as controllers.impedance.parameters.kp=300, found " + text);
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::string editScenario(const std::string& text, const std::vector<ScenarioSetting>& settings) {
  YAML::Node root = YAML::Load(text);
  for (const auto& [path, value] : settings) {
    YAML::Node parsed;
    try {
      parsed = YAML::Load(value);
    } catch (const YAML::Exception&) {
      throw UsageError("--set " + path + ": expected a value in YAML, found " + value);
    }
    set(root, partsOf(path), 0, parsed, path);
  }
  return textOf(root);
}

std::string keepInScenario(const std::string& text, const std::string& key,
                           const std::function<bool(std::size_t)>& keeps) {
  YAML::Node root = YAML::Load(text);
  if (!root[key].IsDefined()) return text;
  YAML::Node kept(YAML::NodeType::Sequence);
  for (std::size_t i = 0; i < root[key].size(); ++i) {
    if (keeps(i)) kept.push_back(root[key][i]);
  }
  root[key] = kept;
  return textOf(root);
}

std::string appendToScenario(const std::string& text, const std::string& key, const std::vector<std::string>& entries) {
  if (entries.empty()) return text;
  YAML::Node root = YAML::Load(text);
  for (const std::string& entry : entries) root[key].push_back(YAML::Load(entry));
  return textOf(root);
}

std::string withController(const std::string& text, const std::string& name, const std::string& law,
                           const std::string& parameters) {
  if (!isName(name)) throw UsageError(std::string("expected ") + kNameRule + ", found '" + name + "'");
  const YAML::Node controllers = YAML::Load(text)["controllers"];
  const auto known = std::find_if(controllers.begin(), controllers.end(),
                                  [&](const YAML::Node& one) { return one["name"].as<std::string>("") == name; });
  const bool is_new = known == controllers.end();
  if (is_new && law.empty()) {
    throw UsageError("no controller is called " + name + ": a new one needs a law, --law L; see `baton laws`");
  }
  const std::string entry = "{name: " + name + ", law: " + law + "}";
  const std::string place = "controllers." + name;
  std::vector<ScenarioSetting> settings;
  if (!is_new && !law.empty() && (*known)["law"].as<std::string>("") != law) settings.emplace_back(place, entry);
  std::istringstream lines(parameters);
  for (std::string line; std::getline(lines, line);) {
    const auto& [parameter, value] = parseSetting(line);
    settings.emplace_back(place + ".parameters." + parameter, value);
  }
  return editScenario(is_new ? appendToScenario(text, "controllers", {entry}) : text, settings);
}

}  // namespace baton
