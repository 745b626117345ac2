/// What a run's recording says of itself, beside its messages.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mcap/reader.hpp"
#include "runtime/scenario.hpp"

namespace baton {

/// An attachment's text; nothing when there is none of that name. Throws FormatError when it is damaged.
[[nodiscard]] std::optional<std::string> attachmentText(const mcap::Reader& reader, const std::string& name);

/// The same of one that every run's recording has. Throws UsageError when there is none.
[[nodiscard]] std::string neededAttachment(const mcap::Reader& reader, const std::string& name,
                                           const std::filesystem::path& file);

/// The scenario that the run began with. Throws UsageError when the file is not the recording of a run.
[[nodiscard]] Scenario recordedScenario(const mcap::Reader& reader, const std::filesystem::path& file);

/// Whether a message of the topic is in the recording.
[[nodiscard]] bool hasTopic(const mcap::Reader& reader, const std::string& topic);

/// Throws UsageError when the recording is without a topic that every run has.
void expectTopic(const mcap::Reader& reader, const std::string& topic, const std::filesystem::path& file);

/// The same of one on which a run need not say anything: it is missed when it was left out on purpose.
void expectNotLeftOut(const mcap::Reader& reader, const std::string& topic, const std::filesystem::path& file);

/// A metadata record; of several with one name, the first value of each key. Empty when there is none.
[[nodiscard]] mcap::StringMap metadataOf(const mcap::Reader& reader, const std::string& record);

/// A value of a metadata record; empty when there is no such record or key.
[[nodiscard]] std::string metadataValue(const mcap::Reader& reader, const std::string& record, const std::string& key);

/// Complete, by the recording's own certificate.
[[nodiscard]] bool isCertified(const mcap::Reader& reader);

/// The place of the file among the parts of a recording that was split; nothing when it was not.
[[nodiscard]] std::optional<unsigned> partIndex(const mcap::Reader& reader);

/// The last take of a run: how often it has been reset before, and the log time from which on everything belongs to it;
/// 0 when it never was. Where the topic that announces a reset was left out, a take begins where the steps of the
/// states go back.
struct Take {
  std::uint32_t number = 0;
  std::uint64_t begin_ns = 0;
};
[[nodiscard]] Take lastTake(const mcap::Reader& reader);
/// Where it begins.
[[nodiscard]] std::uint64_t lastTakeBegin(const mcap::Reader& reader);

}  // namespace baton
