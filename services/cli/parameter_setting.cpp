#include "parameter_setting.hpp"

#include <vector>

#include "base/error.hpp"
#include "base/number.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

ParameterValue readValue(const YamlNode& node) {
  if (node.isList()) {
    std::vector<double> values;
    for (const YamlNode& item : node.list(0, 64)) values.push_back(item.number());
    return values;
  }
  try {
    return std::vector<double>{node.number()};
  } catch (const UsageError&) {
    if (!commaHint(node.text()).empty()) throw;
    return node.text();
  }
}

}  // namespace

std::pair<std::string, ParameterValue> parseParameter(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == setting.size()) {
    throw UsageError("expected NAME=VALUE, such as kp=300 or kp=[300, 300, 100], found " + setting);
  }
  return {setting.substr(0, equals), readValue(YamlNode::parse(setting, setting.substr(equals + 1)))};
}

}  // namespace baton
