/// The IDL of every type of idl/, flattened (no comments, no preprocessor lines), so that a recording can explain
/// itself.
#pragma once

#include <span>
#include <string_view>

namespace baton::msg {

struct IdlText {
  std::string_view type_name;  // "baton::msg::PlantState"
  std::string_view text;       // self-contained
};

[[nodiscard]] std::span<const IdlText> allIdlTexts();

}  // namespace baton::msg
