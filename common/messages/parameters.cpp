#include "messages/parameters.hpp"

#include <algorithm>
#include <sstream>

namespace baton {

msg::ParameterValue toMessage(const std::string& name, const ParameterValue& value) {
  msg::ParameterValue message;
  assignText(name, "a parameter's name", message.name());
  if (const auto* word = std::get_if<std::string>(&value)) {
    assignText(*word, "parameter '" + name + "'", message.word());
    return message;
  }
  const auto& numbers = std::get<std::vector<double>>(value);
  if (numbers.size() > msg::MAX_JOINTS) {
    throw UsageError("parameter '" + name + "': expected at most " + std::to_string(msg::MAX_JOINTS) +
                     " numbers, found " + std::to_string(numbers.size()));
  }
  message.numbers() = numbers;
  return message;
}

std::vector<msg::ParameterValue> toMessages(const ParameterValues& values) {
  std::vector<msg::ParameterValue> messages;
  for (const auto& [name, value] : values) messages.push_back(toMessage(name, value));
  return messages;
}

ParameterValues fromMessages(const std::vector<msg::ParameterValue>& messages) {
  ParameterValues values;
  for (const msg::ParameterValue& one : messages) {
    const std::string name = one.name().c_str();
    const bool is_new = one.numbers().empty() ? values.emplace(name, one.word().c_str()).second
                                              : values.emplace(name, one.numbers()).second;
    if (!is_new) throw UsageError("parameter '" + name + "': expected one value, found several");
  }
  return values;
}

std::string toText(const ParameterValue& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  const auto& numbers = std::get<std::vector<double>>(value);
  std::ostringstream text;
  const bool is_one = std::adjacent_find(numbers.begin(), numbers.end(), std::not_equal_to<>()) == numbers.end();
  if (is_one && !numbers.empty()) {
    text << numbers.front();  // which stands for all
    return text.str();
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i == 0 ? "[" : ", ") << numbers[i];
  text << "]";
  return text.str();
}

std::string toText(const ParameterValues& values) {
  std::string text;
  for (const auto& [name, value] : values) text += (text.empty() ? "" : ", ") + name + " = " + toText(value);
  return text;
}

}  // namespace baton
