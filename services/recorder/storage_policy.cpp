#include "storage_policy.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace baton {
namespace {

double mega(std::uint64_t bytes) { return static_cast<double>(bytes) * 1e-6; }

std::uint64_t closingBytes(const RecordingConfig& config, const Storage& storage) {
  return closingBytes(config, storage.part_bytes, storage.declared_bytes);
}

bool isOverBudget(const RecordingConfig& config, const Storage& storage) {
  return config.max_bytes > 0 &&
         storage.closed_bytes + storage.part_bytes + closingBytes(config, storage) >= config.max_bytes;
}

}  // namespace

bool isDiskLow(const RecordingConfig& config, const Storage& storage) {
  return config.min_free_bytes > 0 && storage.free_bytes < config.min_free_bytes + closingBytes(config, storage);
}

bool isPartFull(const RecordingConfig& config, std::uint64_t part_bytes, std::uint64_t part_steps) {
  return (config.split_bytes > 0 && part_bytes >= config.split_bytes) ||
         (config.split_steps > 0 && part_steps >= config.split_steps);
}

std::uint64_t closingBytes(const RecordingConfig& config, std::uint64_t part_bytes, std::uint64_t declared_bytes) {
  // Measured: chunks hold 1500 messages of some 20 channels; the index of one takes 400 bytes of 60 kB compressed. The
  // certificate and what is known of a run take less than 40 kB, with the declarations of a usual run less than 100.
  constexpr std::uint64_t kUsual = 100'000, kOfRun = 40'000, kIndexShare = 50;
  std::uint64_t summary = std::max(kUsual, declared_bytes + kOfRun);
  if (config.max_bytes > 0) summary = std::min(summary, config.max_bytes / 4);
  const std::uint64_t last_chunk = config.chunk_bytes + declared_bytes;  // which repeats what it uses
  return last_chunk + part_bytes / kIndexShare + summary;
}

StorageVerdict judgeStorage(const RecordingConfig& config, const Storage& storage) {
  if (!isOverBudget(config, storage) && !isDiskLow(config, storage)) return StorageVerdict::kGoOn;
  return config.drops_oldest && storage.closed_parts > 0 ? StorageVerdict::kDropOldest : StorageVerdict::kStop;
}

std::string roomObjection(const RecordingConfig& config, std::uint64_t bytes, std::uint64_t declared_bytes,
                          std::uint64_t free_bytes) {
  const std::uint64_t needed = bytes + closingBytes(config, bytes, declared_bytes);
  if (config.min_free_bytes == 0 || free_bytes >= config.min_free_bytes + needed) return "";
  return fmt::format(
      "up to {:.1f} MB would be written, and recording.min_free_MB, {:g}, has to be left: the disk has "
      "{:.1f} MB; make room, or write to another disk with --out",
      mega(needed), mega(config.min_free_bytes), mega(free_bytes));
}

std::string reachedText(const RecordingConfig& config, const Storage& storage, const LimitNames& names) {
  if (isDiskLow(config, storage)) {
    return fmt::format("{}, {:g}, is reached: the disk has {:.1f} MB left", names.min_free, mega(config.min_free_bytes),
                       mega(storage.free_bytes));
  }
  return fmt::format("{}, {:g}, is reached", names.max, mega(config.max_bytes));
}

}  // namespace baton
