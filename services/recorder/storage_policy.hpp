/// When a recording goes on in another part, and when the disk has no more room for it: decisions alone.
#pragma once

#include <cstdint>
#include <string>

#include "runtime/scenario.hpp"

namespace baton {

/// @param part_bytes  of the part being written.  @param part_steps  of the run since it began.
[[nodiscard]] bool isPartFull(const RecordingConfig& config, std::uint64_t part_bytes, std::uint64_t part_steps);

/// How a recording stands on its disk.
struct Storage {
  std::uint64_t closed_bytes = 0;    // of parts that are finished
  std::uint64_t part_bytes = 0;      // of the one being written
  std::uint64_t declared_bytes = 0;  // of its schemas and channels
  std::uint64_t closed_parts = 0;
  std::uint64_t free_bytes = 0;  // left on the disk
};

enum class StorageVerdict { kGoOn, kDropOldest, kStop };

/// What the part being written will grow by when it is ended now: its last chunk, the index, the certificate.
[[nodiscard]] std::uint64_t closingBytes(const RecordingConfig& config, std::uint64_t part_bytes,
                                         std::uint64_t declared_bytes);
[[nodiscard]] StorageVerdict judgeStorage(const RecordingConfig& config, const Storage& storage);
/// Whether less than is to be left would be left on the disk, were it ended now.
[[nodiscard]] bool isDiskLow(const RecordingConfig& config, const Storage& storage);
/// Why a file of so many bytes, before compression, is not to be written to a disk with so many left; empty when it is.
[[nodiscard]] std::string roomObjection(const RecordingConfig& config, std::uint64_t bytes,
                                        std::uint64_t declared_bytes, std::uint64_t free_bytes);
/// What the limits are called where they were set.
struct LimitNames {
  const char* max = "recording.max_MB";
  const char* min_free = "recording.min_free_MB";
};
/// What has been reached, for the verdicts that change something: "recording.max_MB, 40, is reached".
[[nodiscard]] std::string reachedText(const RecordingConfig& config, const Storage& storage,
                                      const LimitNames& names = {});

}  // namespace baton
