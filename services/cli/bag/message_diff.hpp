/// Two messages, value by value.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bag/field_rules.hpp"
#include "schema/message_reader.hpp"
#include "schema/step.hpp"

namespace baton {

struct FieldDifference {
  std::string field;  // "tip_position[2]"; empty for the message as a whole
  std::string a;      // values, or what is there in their place
  std::string b;
};

/// A message and its type; a null type for one that stays bytes.
struct TypedPayload {
  const schema::Type* type = nullptr;
  schema::Bytes bytes{};
};

/// The first difference; nothing when there is none. Without rules messages are the same when their bytes are; with
/// rules when all values are that are not ignored, up to their tolerance, and not-a-number is the same as itself.
[[nodiscard]] std::optional<FieldDifference> compare(const TypedPayload& a, const TypedPayload& b,
                                                     const FieldRules& rules);

[[nodiscard]] inline std::optional<std::uint64_t> stepOf(const TypedPayload& message) {
  return message.type == nullptr ? std::nullopt : schema::stepOf(*message.type, message.bytes);
}

}  // namespace baton
