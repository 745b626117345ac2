/// The step of a run that a message belongs to: the member `step` of its struct, a whole number without sign of 64
/// bits.
#pragma once

#include <cstdint>
#include <optional>

#include "schema/message_reader.hpp"

namespace baton::schema {

/// Whether messages of the type have such a member.
[[nodiscard]] bool hasStep(const Type& type);

/// Its value; nothing when the type has none or the bytes are no such message.
[[nodiscard]] std::optional<std::uint64_t> stepOf(const Type& type, Bytes message);

}  // namespace baton::schema
