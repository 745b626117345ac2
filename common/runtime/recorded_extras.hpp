/// What a recording says of itself beside its messages, and which topics it has.
#pragma once

#include <optional>
#include <string>

#include "mcap/source.hpp"

namespace baton {

/// An attachment's text; nothing when there is none of that name. Throws FormatError when it is damaged.
[[nodiscard]] std::optional<std::string> attachmentText(const mcap::Source& reader, const std::string& name);

/// A metadata record; of several with one name, the first value of each key. Empty when there is none.
[[nodiscard]] mcap::StringMap metadataOf(const mcap::Source& reader, const std::string& record);

/// A value of a metadata record; empty when there is no such record or key.
[[nodiscard]] std::string metadataValue(const mcap::Source& reader, const std::string& record, const std::string& key);

/// The index of the first part that a split recording still has, by the certificate in its last one: 0 unless parts
/// were dropped for want of room, and where nothing that can be read says so.
[[nodiscard]] unsigned firstPartKept(const mcap::Source& last_part);

/// Whether a message of the topic is in the recording.
[[nodiscard]] bool hasTopic(const mcap::Source& reader, const std::string& topic);

/// Whether a certificate says what was recorded: its own, or in a copy that of the whole.
[[nodiscard]] bool hasCertificate(const mcap::Source& reader);

/// Whether the topic was left out of the recording on purpose: by its certificate, or by a copy that took only some
/// topics of one that had it.
[[nodiscard]] bool isLeftOut(const mcap::Source& reader, const std::string& topic);

}  // namespace baton
