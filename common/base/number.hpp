/// Numbers as people write them on command lines and in files, in one way everywhere: 1, +1, -0.5, 1e-3.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>

namespace baton {

/// The whole text as a number of that type; nothing for any other text, for what the type does not hold, and for what
/// is not finite.
template <class Number>
[[nodiscard]] std::optional<Number> numberIn(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // which from_chars does not know
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::floating_point<Number>) {
    if (!std::isfinite(number)) return std::nullopt;
  }
  return number;
}

/// "; the decimal sign is a point: 0.5" for a number that is written with a comma; empty for any other text.
[[nodiscard]] std::string commaHint(std::string_view text);

}  // namespace baton
