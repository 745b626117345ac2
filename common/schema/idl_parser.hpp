/// Reads the self-contained OMG IDL text that recordings carry (MCAP schema encoding "omgidl").
///
/// Understood: modules; structs, derived and empty ones too; enums, with values of their own or not; bit masks; unions
/// on an enum, a boolean, a character or an integer; sequences and strings, bounded or not; arrays of any number of
/// dimensions; typedefs, of a type that they define, too; constants; boolean, octet, char, wchar (two bytes, as in
/// DDS-XTypes 1.3), int8 to uint64, short to unsigned long long, float, double. Sizes, bounds, labels and values are
/// constant expressions (idl_values.hpp). A name may be escaped (_struct), and be a word that IDL knows elsewhere (map,
/// any, int8). A struct or union that is declared and defined later, or is being defined, may stand in a sequence.
///
/// Of annotations @unit, @key, @value and, of a bit mask, @bit_bound and @position are kept, and those that change how
/// a payload is read are refused by name: @mutable, @optional, @non_serialized, and @bit_bound of an enum, where
/// vendors differ. All others (@final and @appendable, which are the same in plain CDR; @id, @default, @verbatim,
/// @external, a vendor's own) are skipped, and so is the declaration of an annotation. Everything else is refused: wide
/// strings, long double, maps, bit sets, structs defined within structs.
///
/// What is refused costs the definition it is in, and those that use it: they are no types, TypeSet::problemOf() says
/// why, and the rest of the text is read. What #define, #if and #ifdef say is done before (idl_preprocessor.hpp);
/// #pragma and, between definitions, other lines for a preprocessor are skipped: nothing is included.
#pragma once

#include <string_view>

#include "schema/type.hpp"

namespace baton::schema {

/// Throws IdlError, with the line, for a text that goes beyond what limits.hpp allows a whole text.
[[nodiscard]] TypeSet parseIdl(std::string_view text);

}  // namespace baton::schema
