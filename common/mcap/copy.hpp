/// New recordings out of old ones: all that can be read of one that was cut or damaged, a part of one, several in one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "mcap/reader.hpp"
#include "mcap/writer.hpp"

namespace baton::mcap {

/// Writes the copy. A copy that is not finished is removed: nobody takes it for one. The readers must outlive it.
class Copier {
 public:
  /// Throws what Writer's constructor throws.
  explicit Copier(const std::filesystem::path& out, const WriterOptions& options = {});
  ~Copier();
  Copier(const Copier&) = delete;
  Copier& operator=(const Copier&) = delete;

  /// The channel in the copy. Channels that are equal in all but their number, schemas too, are one in the copy,
  /// whatever files they come from; two writers differ in their channels' metadata.
  ChannelId channel(const Channel& channel, const Schema* schema);
  /// All of the file, those without a message too.
  void channels(const Reader& reader);
  void message(const MessageView& message);
  /// @param name  the name in the copy.
  void metadata(const std::string& name, const StringMap& values) { writer_.addMetadata(name, values); }
  void attachment(const std::string& name, const AttachmentIndex& index, ByteView data);
  /// Closes the file: it is there now.
  void finish();

  [[nodiscard]] std::uint64_t messages() const { return writer_.statistics().messages; }

 private:
  Writer writer_;
  bool is_finished_ = false;
  std::unordered_map<const Channel*, ChannelId> known_;  // the readers' channels, so far
  std::map<std::string, ChannelId> written_;             // by all but their number
};

/// What recover() found and did.
struct Recovery {
  FileInfo info{};                  // of the file that was read
  std::vector<Damage> lost{};       // by place: what could not be read; empty when nothing was lost
  std::uint64_t lost_bytes = 0;     // of the file, that could not be read
  std::uint64_t lost_messages = 0;  // at least: by what is left of the indexes
  std::uint64_t lost_chunks = 0;    // likewise
  bool is_changed = false;          // bytes are not as they were written, by the CRC of the data: something may be lost
  bool is_whole = false;            // nothing was lost or left out, and no byte is another than was written
  std::uint64_t messages = 0;       // in the copy, as what follows
  std::uint64_t attachments = 0;
  std::uint64_t metadata = 0;
};

struct RecoverOptions {
  ReaderOptions reader{};  // its on_damage and on_progress are not called
  WriterOptions writer{};  // its profile becomes the file's
  /// The name, in a copy from which something is missing or that joins recordings, of a metadata record or attachment;
  /// as it was when not given.
  std::function<std::string(const std::string&)> lossy_name{};
  std::function<void(double)> progress{};  // told which part of the work is done, from 0 to 1
};

/// Makes a finished, indexed file of everything that can be read of `in`: schemas, channels, messages in their order,
/// metadata, attachments, but no records of kinds that are not known. Where the file cannot be read it goes on at the
/// next chunk that can. Throws FormatError when `in` does not begin as an MCAP file, UnavailableError when it cannot be
/// opened or `out` cannot be made, and WriteError.
Recovery recover(const std::filesystem::path& in, const std::filesystem::path& out, const RecoverOptions& options);

}  // namespace baton::mcap
