/// What a run's recording says of itself, beside its messages.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mcap/reader.hpp"
#include "runtime/recorded_extras.hpp"
#include "runtime/recorded_take.hpp"
#include "runtime/scenario.hpp"

namespace baton {

/// The text of an attachment that every run's recording has. Throws UsageError when there is none.
[[nodiscard]] std::string neededAttachment(const mcap::Reader& reader, const std::string& name,
                                           const std::filesystem::path& file);

/// The scenario that the run began with. Throws UsageError when the file is not the recording of a run.
[[nodiscard]] Scenario recordedScenario(const mcap::Reader& reader, const std::filesystem::path& file);

/// Throws UsageError when the recording is without a topic that every run has.
void expectTopic(const mcap::Reader& reader, const std::string& topic, const std::filesystem::path& file);

/// The same of one on which a run need not say anything: it is missed when it was left out on purpose.
void expectNotLeftOut(const mcap::Reader& reader, const std::string& topic, const std::filesystem::path& file);

/// Complete, by the recording's own certificate.
[[nodiscard]] bool isCertified(const mcap::Reader& reader);

/// The place of the file among the parts of a recording that was split; nothing when it was not.
[[nodiscard]] std::optional<unsigned> partIndex(const mcap::Reader& reader);

}  // namespace baton
