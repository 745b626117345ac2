/// The instance that a message is about: the values of its type's members with @key.
#pragma once

#include <string>

#include "schema/message_reader.hpp"

namespace baton::schema {

/// Equal for messages of one instance. Empty for a type without keys, and for bytes that are no such message. Keys of
/// the message itself count, with all that is within them; those of structs within members that are no keys do not.
[[nodiscard]] std::string instanceOf(const Type& type, Bytes message);

}  // namespace baton::schema
