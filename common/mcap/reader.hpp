/// Reads a recording: finished, cut off by a crash or a full disk, or written by somebody else.
///
/// Nothing in the file is believed before it is checked: lengths against the bytes that are there, sizes against a
/// limit, contents against their CRCs. The only memory used for messages is that of the chunks being read.
///
///   const mcap::Reader reader("run.mcap");
///   mcap::MessageCursor messages = reader.messages({.topics = {"baton/plant_state"}});
///   for (mcap::MessageView message; messages.next(message);) use(message.data);
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mcap/cursor.hpp"
#include "mcap/source.hpp"

namespace baton::mcap {

/// Shows how far the opening of a file is: how many bytes have been read of how many; at the end, also of a failure,
/// all.
using OpeningSink = std::function<void(const std::filesystem::path& file, std::uint64_t done, std::uint64_t of)>;

/// Of all files that are opened without ReaderOptions::on_progress. A program sets it before it opens one; threads that
/// open files call it at the same time.
void setOpeningSink(OpeningSink sink);

class Reader : public Source {
 public:
  /// Reads the whole file once, so that no index is taken that contradicts the data (unless
  /// ReaderOptions::trusts_summary). Throws UnavailableError when the file cannot be opened, UsageError when it
  /// decompresses to more than is allowed, FormatError when it is not MCAP, and, where it has no summary that its data
  /// agree with, at the first damaged chunk (see ReaderOptions::on_damage).
  explicit Reader(const std::filesystem::path& path, ReaderOptions options = {});
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  [[nodiscard]] const FileInfo& info() const override { return index_.info; }
  [[nodiscard]] const std::map<SchemaId, Schema>& schemas() const override { return index_.schemas; }
  [[nodiscard]] const std::map<ChannelId, Channel>& channels() const override { return index_.channels; }
  [[nodiscard]] const Statistics& statistics() const override { return index_.statistics; }
  [[nodiscard]] const std::vector<AttachmentIndex>& attachments() const override { return index_.attachments; }
  [[nodiscard]] Bytes readAttachment(const AttachmentIndex& attachment) const override;
  [[nodiscard]] const std::vector<MetadataIndex>& metadataIndexes() const { return index_.metadata; }
  /// A metadata record. Throws FormatError when it is damaged.
  /// @param index  one of metadataIndexes().
  [[nodiscard]] Metadata readMetadata(const MetadataIndex& index) const;
  [[nodiscard]] std::vector<Metadata> metadata() const override;

  /// The messages that pass the filter, to be taken one by one.
  [[nodiscard]] MessageCursor messages(const MessageFilter& filter = {}) const;
  void forEachMessage(const MessageFilter& filter,
                      const std::function<void(const MessageView&)>& callback) const override;

  /// Reads the whole data section and compares it with the CRC at its end. Nothing when there is no such CRC: the file
  /// was written without, or was cut before it.
  [[nodiscard]] std::optional<bool> dataCrcMatches() const;

 private:
  [[nodiscard]] std::optional<bool> dataCrcMatches(std::uint64_t begin, std::uint64_t end) const;

  ReaderOptions options_;
  InputFile file_;
  FileIndex index_;
};

}  // namespace baton::mcap
