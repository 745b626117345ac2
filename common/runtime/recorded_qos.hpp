/// The QoS of a recorded writer, as its channel's metadata has it.
#pragma once

#include <charconv>
#include <limits>
#include <map>
#include <string>

#include "mcap/records.hpp"

namespace baton {

/// Policies by name: "durability" is "transient_local" or "volatile", "reliability", "ownership", "keyed", ...; what is
/// not recorded is not there.
[[nodiscard]] std::map<std::string, std::string> recordedQos(const mcap::StringMap& metadata);

/// 0 for what is not recorded, negative, or no number; the largest there is for what is beyond it.
template <class Number>
[[nodiscard]] Number recordedNumber(const std::map<std::string, std::string>& values, const std::string& key) {
  const auto found = values.find(key);
  const std::string text = found == values.end() ? "" : found->second;
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (end != text.data() + text.size() || text.starts_with('-')) return 0;
  return error == std::errc::result_out_of_range ? std::numeric_limits<Number>::max() : number;
}

}  // namespace baton
