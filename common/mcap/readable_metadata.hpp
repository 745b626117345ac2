/// What can be read of a recording's metadata, for whoever does without the rest.
#pragma once

#include <vector>

#include "mcap/error.hpp"
#include "mcap/reader.hpp"

namespace baton::mcap {

/// The metadata records that are not damaged, in file order.
[[nodiscard]] inline std::vector<Metadata> readableMetadata(const Reader& file) {
  std::vector<Metadata> records;
  for (const MetadataIndex& index : file.metadataIndexes()) {
    try {
      records.push_back(file.readMetadata(index));
    } catch (const FormatError&) {  // one damaged record says nothing of the others
    }
  }
  return records;
}

}  // namespace baton::mcap
