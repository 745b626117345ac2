/// Any bytes as a recording: read by its index and from its start, with metadata and attachments, and recovered. What
/// is recovered must be sound, and hold what could be read.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "mcap/copy.hpp"

namespace {

using namespace baton::mcap;

constexpr std::uint64_t kLimitBytes = 1 << 20;

void require(bool claim) {
  if (!claim) std::abort();
}

/// A file without a disk.
class MemoryFile {
 public:
  explicit MemoryFile(ByteView bytes) : fd_(::memfd_create("fuzz", 0)) {
    require(fd_ >= 0 && ::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

ReaderOptions tolerant(bool check_crc) {
  ReaderOptions options;
  options.max_chunk_bytes = kLimitBytes;
  options.check_crc = check_crc;
  options.on_damage = [](const Damage&) {};
  return options;
}

/// What reading a file gives, whatever becomes of it.
struct Contents {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  bool operator==(const Contents&) const = default;
};

Contents contentsOf(const Reader& reader, MessageFilter::Order order) {
  Contents found;
  std::uint64_t latest = 0;
  reader.forEachMessage({.order = order}, [&](const MessageView& message) {
    require(order == MessageFilter::Order::kFile || message.log_time_ns >= latest);
    latest = message.log_time_ns;
    ++found.messages;
    for (const std::byte byte : message.data) found.bytes = found.bytes * 31 + std::to_integer<std::uint64_t>(byte);
  });
  return found;
}

/// Reads all there is; what is wrong with the file may only be said by a FormatError.
void readAll(const std::string& path, ReaderOptions options) {
  bool is_damaged = false;
  if (options.on_damage) options.on_damage = [&is_damaged](const Damage&) { is_damaged = true; };
  try {
    const Reader reader(path, options);
    (void)reader.dataCrcMatches();
    for (const auto& index : reader.metadataIndexes()) {
      try {
        (void)reader.readMetadata(index);
      } catch (const FormatError&) {
      }
    }
    for (const auto& index : reader.attachments()) {
      try {
        (void)reader.readAttachment(index);
      } catch (const FormatError&) {
      }
    }
    const Contents in_order = contentsOf(reader, MessageFilter::Order::kLogTime);
    require(is_damaged || in_order.messages == contentsOf(reader, MessageFilter::Order::kFile).messages);
  } catch (const FormatError&) {
  }
}

void recoverAll(const std::string& path, bool check_crc) {
  RecoverOptions options;
  options.reader = tolerant(check_crc);
  options.writer.compression = Compression::kNone;
  options.writer.chunk_bytes = 4096;
  options.writer.sync_on_close = false;
  options.writer.if_exists = OutputFile::IfExists::kReplace;
  const MemoryFile out({}), again({});
  Recovery first;
  try {
    first = recover(path, out.path(), options);
  } catch (const FormatError&) {
    return;  // not a recording at all
  }
  const Reader copy(out.path());  // strict
  require(copy.info().is_complete && copy.info().has_summary && copy.info().problem.empty());
  require(copy.dataCrcMatches() == true);
  require(copy.statistics().message_count == first.messages);
  require(copy.attachments().size() == first.attachments && copy.metadata().size() == first.metadata);
  const Contents found = contentsOf(copy, MessageFilter::Order::kFile);
  require(found == contentsOf(Reader(path, options.reader), MessageFilter::Order::kFile));
  const Recovery second = recover(out.path(), again.path(), options);
  require(second.lost.empty() && second.messages == first.messages);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(std::as_bytes(std::span(data, size)));
  for (const bool check_crc : {true, false}) {  // without, what is behind the checksums is reached too
    ReaderOptions strict = tolerant(check_crc);
    strict.on_damage = nullptr;
    readAll(file.path(), strict);
    readAll(file.path(), tolerant(check_crc));
    recoverAll(file.path(), check_crc);
  }
  return 0;
}
