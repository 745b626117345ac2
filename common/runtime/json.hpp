/// JSON as Baton writes it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace baton {

/// Indented by one. Names from outside may be any bytes: what is not UTF-8 is replaced, not thrown at.
[[nodiscard]] inline std::string toText(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace baton
