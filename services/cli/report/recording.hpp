/// What a run's recording says of itself, beside its messages.
#pragma once

#include <optional>
#include <string>

#include "mcap/reader.hpp"

namespace baton {

/// An attachment's text; nothing when there is none of that name. Throws FormatError when it is damaged.
[[nodiscard]] std::optional<std::string> attachmentText(const mcap::Reader& reader, const std::string& name);

/// A value of a metadata record; empty when there is no such record or key.
[[nodiscard]] std::string metadataValue(const mcap::Reader& reader, const std::string& record, const std::string& key);

/// Complete, by the recording's own certificate.
[[nodiscard]] bool isCertified(const mcap::Reader& reader);

/// Log time from which on everything belongs to the last take of a run that has been reset; 0 when it never was.
[[nodiscard]] std::uint64_t lastTakeBegin(const mcap::Reader& reader);

}  // namespace baton
