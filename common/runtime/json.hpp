/// JSON as Baton writes it.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "base/text.hpp"

namespace baton {

/// Indented by one. Names from outside may be any bytes: what is not UTF-8 is replaced, not thrown at, and
/// control characters are escaped.
[[nodiscard]] inline std::string toText(const nlohmann::ordered_json& json) {
  return escapedInJson(json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

/// JSON has no number that is not finite: null stands for it.
[[nodiscard]] inline nlohmann::ordered_json orNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace baton
