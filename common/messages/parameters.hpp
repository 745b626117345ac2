/// Values of parameters to messages and back. What a law makes of them is not known here: completeParameters() checks.
#pragma once

#include <string>
#include <vector>

#include "base/error.hpp"
#include "control/parameters.hpp"
#include "msg/parameter.h"

namespace baton {

/// A bounded string would cut what is too long without a word: throws UsageError, which says what the text is `of`.
template <class BoundedString>
void assignText(const std::string& text, const std::string& of, BoundedString& to) {
  if (text.size() > BoundedString::max_size) {
    throw UsageError(of + ": expected at most " + std::to_string(BoundedString::max_size) + " characters, found '" +
                     text + "'");
  }
  to = text;
}

/// Throws UsageError for a name, a word or a list too long for the message.
[[nodiscard]] msg::ParameterValue toMessage(const std::string& name, const ParameterValue& value);
[[nodiscard]] std::vector<msg::ParameterValue> toMessages(const ParameterValues& values);

/// Throws UsageError when a parameter is there twice.
[[nodiscard]] ParameterValues fromMessages(const std::vector<msg::ParameterValue>& messages);

/// As people read and write it: "300", "corrected", "[30, 30, 20]"; one number for as many that are equal.
[[nodiscard]] std::string toText(const ParameterValue& value);
/// "kp = 300, form = corrected, kd = [30, 30, 20]".
[[nodiscard]] std::string toText(const ParameterValues& values);

}  // namespace baton
