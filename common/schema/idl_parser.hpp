/// Reads the self-contained OMG IDL text that recordings carry (MCAP schema encoding "omgidl").
///
/// Understood: modules; structs; enums, which count from 0; unions on an enum, a boolean or an integer; sequences and
/// strings, bounded or not; arrays of any number of dimensions; typedefs; constants, as bounds and labels; boolean,
/// octet, char, int8 to uint64, short to unsigned long long, float, double. Of annotations @unit and @key are kept;
/// @final, @min, @max, @range, @default, @id, @topic and @nested change nothing in a payload and are skipped.
/// Everything else is refused, above all what would change how a payload is read (@appendable, @mutable, @optional,
/// @bit_bound, inheritance, wide characters, long double, maps, bit masks).
#pragma once

#include <string_view>

#include "schema/type.hpp"

namespace baton::schema {

/// Throws IdlError, with the line, for a text that is not as above or goes beyond limits.hpp.
[[nodiscard]] TypeSet parseIdl(std::string_view text);

}  // namespace baton::schema
