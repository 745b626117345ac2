/// Readers and writers of raw payloads. Typed ones (typed.hpp) stand on these.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>

#include "dds/participant.hpp"
#include "dds/types.hpp"

namespace baton::dds {

/// How a writer shows that it lives, and how often at least.
struct Liveliness {
  enum class Kind { kAutomatic, kManualByParticipant, kManualByTopic };
  Kind kind = Kind::kAutomatic;
  std::int64_t lease_ns = 0;  // 0, and beyond 68 years: for ever
  bool operator==(const Liveliness&) const = default;
};

struct EndpointOptions {
  std::string topic;
  std::string type;  // "baton::msg::PlantState"
  Profile profile = Profile::kLoop;
  std::uint32_t max_payload = 1024;  // bytes; memory is set aside for this much, larger samples still pass
  bool keyed = false;                // must equal the other side's
  bool exclusive_ownership = false;  // likewise
  bool best_effort = false;          // writer: does not resend; reader: also match writers that do not
  bool any_encoding = false;         // reader: of bytes alone, also match writers that send XCDR2 (from Fast DDS 3 on)
  // What readers may demand of a writer beyond the profile; readers of Baton demand nothing of it.
  std::int64_t deadline_ns = 0;          // writer: promises a sample at least this often; 0, and beyond 68 years: none
  Liveliness liveliness{};               // writer
  std::uint32_t ownership_strength = 0;  // writer, exclusive
  bool operator==(const EndpointOptions&) const = default;
};

/// Called when a counterpart is matched or lost, on a DDS thread.
using MatchCallback = std::function<void()>;
/// Whether samples of this writer are wanted; asked for each sample, by the thread that takes it.
using WriterFilter = std::function<bool(const Guid& writer)>;

class RawWriter {
 public:
  /// Throws UnavailableError when DDS refuses.
  RawWriter(Participant& participant, const EndpointOptions& options, MatchCallback on_match = {});
  ~RawWriter();
  RawWriter(const RawWriter&) = delete;
  RawWriter& operator=(const RawWriter&) = delete;

  /// Sends a payload, encapsulation header included, with the time of the participant's clock. Never blocks. Returns
  /// false when DDS refuses it.
  [[nodiscard]] bool write(std::span<const std::byte> payload) noexcept;
  /// The same with the source timestamp of the original, for replays.
  [[nodiscard]] bool write(std::span<const std::byte> payload, std::int64_t source_timestamp_ns) noexcept;

  [[nodiscard]] std::set<GuidPrefix> matched() const;
  [[nodiscard]] Guid guid() const;
  [[nodiscard]] std::uint64_t count() const;  // samples written; sequence numbers run from 1 to this
  /// Waits until every matched reader has acknowledged everything, at most `timeout_ms`.
  bool waitForAcknowledgments(int timeout_ms);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class RawReader {
 public:
  using Callback = std::function<void(const RawSample&)>;

  /// The callback runs on a DDS thread, once a sample, in order of arrival and for each writer in the order of its
  /// sequence numbers. Of keyed topics it is also told of what has no data.
  RawReader(Participant& participant, const EndpointOptions& options, Callback callback, MatchCallback on_match = {},
            WriterFilter filter = {});
  ~RawReader();
  RawReader(const RawReader&) = delete;
  RawReader& operator=(const RawReader&) = delete;

  [[nodiscard]] std::set<GuidPrefix> matched() const;
  /// Samples of writers that were not admitted.
  [[nodiscard]] std::uint64_t refused() const;
  /// Samples the middleware itself knows it could not deliver.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace baton::dds
