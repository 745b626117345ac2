/// What a run's recording says of itself, beside its messages.
#pragma once

#include <optional>
#include <string>

#include "mcap/joined_reader.hpp"
#include "runtime/recorded_extras.hpp"
#include "runtime/recorded_take.hpp"
#include "runtime/scenario.hpp"

namespace baton {

/// The text of an attachment that every run's recording has. Throws UsageError when there is none.
[[nodiscard]] std::string neededAttachment(const mcap::Source& reader, const std::string& name,
                                           const mcap::FileList& file);

/// The scenario that the run began with. Throws UsageError when the file is not the recording of a run.
[[nodiscard]] Scenario recordedScenario(const mcap::Source& reader, const mcap::FileList& file);

/// Throws UsageError when the recording is without a topic that every run has.
void expectTopic(const mcap::Source& reader, const std::string& topic, const mcap::FileList& file);

/// The same of one on which a run need not say anything: it is missed when it was left out on purpose.
void expectNotLeftOut(const mcap::Source& reader, const std::string& topic, const mcap::FileList& file);

/// Complete, by the recording's own certificate.
[[nodiscard]] bool isCertified(const mcap::Source& reader);

/// The place of the file among the parts of a recording that was split; nothing when it was not.
[[nodiscard]] std::optional<unsigned> partIndex(const mcap::Source& reader);

}  // namespace baton
