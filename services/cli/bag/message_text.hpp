/// Decoded messages as text.
///
/// Numbers are the shortest text that reads back as exactly the same number; floating-point ones always have a point or
/// an exponent. Integers have all their digits, those beyond 2^53 too. What is not finite is NaN, Infinity or
/// -Infinity, in JSON as a string. An enum is its enumerator's name, or its number when it has none. A sequence or an
/// array of octets is hex.
#pragma once

#include <string>

#include "mcap/reader.hpp"
#include "schema/message_reader.hpp"

namespace baton {

[[nodiscard]] std::string hexOf(schema::Bytes bytes);

/// A value without quotes: for tables and sentences. Booleans are 1 and 0 for `is_number`, so that they can be plotted.
[[nodiscard]] std::string plainText(const schema::Type& type, const schema::Value& value, bool is_number = false);

/// A string in quotes. What is not UTF-8 is replaced.
void appendJsonString(std::string& out, std::string_view text);

/// One message of a recording as a JSON object in one line, without its end. With a type its "message" is decoded:
/// structs are objects, unions are objects with the discriminator as "$discriminator" and the member it chose,
/// sequences and arrays are arrays. Without a type (null), and when it is not one of that type, its bytes are in "data"
/// as hex. Returns what is wrong with it, also found in "error"; empty when nothing is.
std::string appendJsonLine(std::string& out, const mcap::MessageView& message, const schema::Type* type);

}  // namespace baton
