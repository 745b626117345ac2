/// Files of other formats, told by how they begin, for messages about a file that stands in the place of another.
#pragma once

#include <string_view>

namespace baton::mcap {

struct ForeignFormat {
  std::string_view magic;
  const char* what;    // behind "it is"
  const char* remedy;  // how a recording or a text comes out of it; empty: in no way
  bool is_packed;      // any file may be in it, of which the remedy makes what it was
};

/// What begins like that; nullptr for everything else.
[[nodiscard]] const ForeignFormat* foreignFormat(std::string_view begin);

}  // namespace baton::mcap
