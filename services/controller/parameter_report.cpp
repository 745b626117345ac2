#include "parameter_report.hpp"

#include "base/error.hpp"
#include "control/law.hpp"

namespace baton {
namespace {

/// A bounded string would cut what is too long without a word.
template <class BoundedString>
void assign(const std::string& text, const std::string& of, BoundedString& to) {
  if (text.size() > BoundedString::max_size) {
    throw UsageError(of + ": expected at most " + std::to_string(BoundedString::max_size) + " characters, found '" +
                     text + "'");
  }
  to = text;
}

msg::Parameter toMessage(const ParameterSpec& spec, const ParameterValue& value) {
  msg::Parameter message;
  assign(spec.name, "parameter name", message.name());
  assign(spec.unit, "unit of parameter " + spec.name, message.unit());
  assign(spec.doc, "doc of parameter " + spec.name, message.doc());
  message.minimum(spec.minimum);
  message.maximum(spec.maximum);
  if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
    message.numbers() = *numbers;
  } else {
    assign(std::get<std::string>(value), "value of parameter " + spec.name, message.word());
  }
  if (spec.choices.size() > msg::MAX_WORDS) throw UsageError("parameter " + spec.name + " has too many choices");
  for (const std::string& word : spec.choices) {
    assign(word, "choice of parameter " + spec.name, message.choices().emplace_back());
  }
  return message;
}

}  // namespace

msg::ParameterStatus parameterReport(const ControllerConfig& config) {
  const LawInfo& law = findLaw(config.law);
  if (law.parameters.size() > msg::MAX_PARAMETERS) throw UsageError("law " + law.name + " has too many parameters");
  msg::ParameterStatus report;
  report.name(config.name);
  report.law(config.law);
  for (const ParameterSpec& spec : law.parameters) {
    report.parameters().push_back(toMessage(spec, config.parameters.at(spec.name)));
  }
  return report;
}

}  // namespace baton
