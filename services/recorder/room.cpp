#include "room.hpp"

#include <sys/statvfs.h>

#include <limits>
#include <utility>

namespace baton {

void Room::measure(const std::filesystem::path& file) {
  struct statvfs disk {};
  const std::filesystem::path folder = file.parent_path();
  const bool is_known = statvfs(folder.empty() ? "." : folder.c_str(), &disk) == 0;
  free_bytes_ = is_known ? std::uint64_t{disk.f_bavail} * disk.f_frsize : std::numeric_limits<std::uint64_t>::max();
}

Room::Outcome Room::makeFor(Recording& recording, std::uint64_t elapsed, std::uint64_t step) {
  Outcome outcome;
  recording.splitWhenFull(elapsed, step);
  for (;;) {
    Storage storage = recording.storage();
    // Others write there as well; between two chunks nothing of ours comes to it.
    const std::uint64_t bytes = storage.closed_bytes + storage.part_bytes;
    if (std::exchange(measured_bytes_, bytes) != bytes) measure(recording.path());
    storage.free_bytes = free_bytes_;
    switch (judgeStorage(config_, storage)) {
      case StorageVerdict::kGoOn: return outcome;
      case StorageVerdict::kStop:
        outcome.is_disk_low = isDiskLow(config_, storage);
        outcome.end = reachedText(config_, storage, names_);
        return outcome;
      case StorageVerdict::kDropOldest:
        recording.dropOldestPart();
        outcome.has_dropped = true;
        break;
    }
  }
}

}  // namespace baton
