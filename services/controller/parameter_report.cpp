#include "parameter_report.hpp"

#include "base/error.hpp"
#include "control/law.hpp"
#include "messages/parameters.hpp"

namespace baton {
namespace {

/// Without its value.
msg::Parameter toMessage(const ParameterSpec& spec) {
  msg::Parameter message;
  assignText(spec.name, "parameter name", message.name());
  assignText(spec.unit, "unit of parameter " + spec.name, message.unit());
  assignText(spec.doc, "doc of parameter " + spec.name, message.doc());
  message.minimum(spec.minimum);
  message.maximum(spec.maximum);
  if (spec.choices.size() > msg::MAX_WORDS) throw UsageError("parameter " + spec.name + " has too many choices");
  for (const std::string& word : spec.choices) {
    assignText(word, "choice of parameter " + spec.name, message.choices().emplace_back());
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
  for (const ParameterSpec& spec : law.parameters) report.parameters().push_back(toMessage(spec));
  fill(law, config.parameters, report);  // a word is one of the choices, so there is room for it
  return report;
}

void fill(const LawInfo& law, const ParameterValues& values, msg::ParameterStatus& report) {
  for (std::size_t i = 0; i < law.parameters.size(); ++i) {
    const ParameterValue& value = values.at(law.parameters[i].name);
    if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
      report.parameters()[i].numbers() = *numbers;
    } else {
      report.parameters()[i].word() = std::get<std::string>(value);
    }
  }
}

}  // namespace baton
