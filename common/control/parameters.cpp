#include "control/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.hpp"
#include "base/plural.hpp"
#include "control/nearest_name.hpp"

namespace baton {
namespace {

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string listed(const std::vector<double>& values) {
  std::ostringstream text;
  for (std::size_t i = 0; i < values.size(); ++i) text << (i == 0 ? "" : ", ") << values[i];
  return text.str();
}

std::string found(const ParameterValue& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return "found '" + *word + "'";
  const auto& values = std::get<std::vector<double>>(value);
  if (values.empty()) return "found no number";
  return "found " + counted(values.size(), "number") + ": " + listed(values);
}

std::string rangeText(const ParameterSpec& spec) {
  std::ostringstream text;
  if (std::isfinite(spec.minimum)) text << " >= " << spec.minimum;
  if (std::isfinite(spec.maximum)) text << (std::isfinite(spec.minimum) ? " and" : "") << " <= " << spec.maximum;
  return text.str();
}

[[noreturn]] void refuse(const ParameterSpec& spec, const std::string& expected, const ParameterValue& value) {
  const std::string unit = spec.unit.empty() ? "" : " [" + spec.unit + "]";
  throw UsageError("parameter '" + spec.name + "'" + unit + ": expected " + expected + ", " + found(value));
}

std::size_t count(ParameterSize size, int n) {
  switch (size) {
    case ParameterSize::kScalar: return 1;
    case ParameterSize::kPerJoint: return static_cast<std::size_t>(n);
    case ParameterSize::kThree: return 3;
    case ParameterSize::kSix: return 6;
    case ParameterSize::kChoice: break;
  }
  return 0;
}

ParameterValue checkedChoice(const ParameterSpec& spec, const ParameterValue& value) {
  const auto* word = std::get_if<std::string>(&value);
  if (word == nullptr || std::find(spec.choices.begin(), spec.choices.end(), *word) == spec.choices.end()) {
    refuse(spec, "one of " + listed(spec.choices), value);
  }
  return value;
}

ParameterValue checkedNumbers(const ParameterSpec& spec, const ParameterValue& value, int n) {
  const std::size_t size = count(spec.size, n);
  const std::string how_many = size == 1 ? "1 number" : "1 or " + std::to_string(size) + " numbers";
  const auto* given = std::get_if<std::vector<double>>(&value);
  if (given == nullptr || (given->size() != 1 && given->size() != size)) refuse(spec, how_many, value);
  for (const double x : *given) {
    if (!std::isfinite(x)) refuse(spec, "finite numbers", value);
    if (x < spec.minimum || x > spec.maximum) refuse(spec, "numbers" + rangeText(spec), value);
  }
  return given->size() == size ? *given : std::vector<double>(size, given->front());
}

}  // namespace

ParameterValues completeParameters(const std::vector<ParameterSpec>& specs, const ParameterValues& given, int n) {
  for (const auto& [name, value] : given) {
    const auto is_named = [&name = name](const ParameterSpec& spec) { return spec.name == name; };
    if (std::none_of(specs.begin(), specs.end(), is_named)) {
      std::vector<std::string> known;
      known.reserve(specs.size());
      for (const ParameterSpec& spec : specs) known.push_back(spec.name);
      throw UsageError(unknownName("parameter", name, known));
    }
  }
  ParameterValues complete;
  for (const ParameterSpec& spec : specs) {
    const auto entry = given.find(spec.name);
    if (spec.size == ParameterSize::kChoice) {
      complete[spec.name] = checkedChoice(spec, entry == given.end() ? spec.choices.front() : entry->second);
    } else {
      complete[spec.name] = checkedNumbers(spec, entry == given.end() ? spec.default_numbers : entry->second, n);
    }
  }
  return complete;
}

const std::vector<double>& numbers(const ParameterValues& values, const std::string& name) {
  return std::get<std::vector<double>>(values.at(name));
}

double number(const ParameterValues& values, const std::string& name) { return numbers(values, name).front(); }

const std::string& choice(const ParameterValues& values, const std::string& name) {
  return std::get<std::string>(values.at(name));
}

}  // namespace baton
