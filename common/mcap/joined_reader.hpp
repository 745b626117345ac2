/// Several files read as one recording: the parts of one that was split, or recordings of one thing made one after
/// another. Nothing is copied; memory is that of the chunks being read, of few files at a time.
///
/// A channel that is the same in several files (topic, type, metadata) is one channel here; those of the first file
/// keep their numbers. What a file repeats from before its beginning is left out when that is in a file before it, by
/// its times (see Repeated). A single file is read as Reader reads it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mcap/reader.hpp"
#include "mcap/repeated.hpp"

namespace baton::mcap {

/// The files of one recording, in their order.
class FileList {
 public:
  FileList(std::filesystem::path file = {}) : paths_{std::move(file)} {}  // NOLINT: one file is a list
  FileList(const std::string& file) : paths_{file} {}                     // NOLINT
  FileList(const char* file) : paths_{file} {}                            // NOLINT
  /// @param paths  at least one.
  explicit FileList(std::vector<std::filesystem::path> paths) : paths_(std::move(paths)) {}

  [[nodiscard]] const std::vector<std::filesystem::path>& paths() const { return paths_; }
  [[nodiscard]] const std::filesystem::path& first() const { return paths_.front(); }
  /// For people: "run.mcap", "run.mcap and 3 more files".
  [[nodiscard]] std::string string() const;

 private:
  std::vector<std::filesystem::path> paths_;
};

class JoinedCursor;

class JoinedReader : public Source {
 public:
  /// Is told of each damaged stretch of a file once, however often it is read.
  using DamageSink = std::function<void(const std::filesystem::path&, const Damage&)>;

  /// Throws what Reader's constructor throws, and UsageError when the files have more channels than one can.
  explicit JoinedReader(const FileList& files, const DamageSink& on_damage = {});
  JoinedReader(const JoinedReader&) = delete;
  JoinedReader& operator=(const JoinedReader&) = delete;

  /// Complete when all files are; otherwise the problem is that of the first that is not, with its name.
  [[nodiscard]] const FileInfo& info() const override { return isOne() ? file(0).info() : info_; }
  [[nodiscard]] const std::map<SchemaId, Schema>& schemas() const override {
    return isOne() ? file(0).schemas() : schemas_;
  }
  [[nodiscard]] const std::map<ChannelId, Channel>& channels() const override {
    return isOne() ? file(0).channels() : channels_;
  }
  [[nodiscard]] const Statistics& statistics() const override { return isOne() ? file(0).statistics() : statistics_; }
  [[nodiscard]] const std::vector<AttachmentIndex>& attachments() const override {
    return isOne() ? file(0).attachments() : attachments_;
  }
  [[nodiscard]] Bytes readAttachment(const AttachmentIndex& attachment) const override;
  [[nodiscard]] std::vector<Metadata> metadata() const override;
  /// What it repeats from before its beginning: what its first file does.
  [[nodiscard]] Repeated repeated() const { return Repeated(file(0)); }
  [[nodiscard]] JoinedCursor messages(const MessageFilter& filter = {}) const;
  void forEachMessage(const MessageFilter& filter,
                      const std::function<void(const MessageView&)>& callback) const override;

 private:
  friend class JoinedCursor;
  struct Route {
    const Channel* channel = nullptr;
    const Schema* schema = nullptr;
  };
  struct Part {
    std::unique_ptr<Reader> reader;
    std::map<ChannelId, Route> routes;  // by the file's own number; empty for a single file
    Repeated repeated;                  // of what a file before this one has
  };

  [[nodiscard]] bool isOne() const { return parts_.size() == 1; }
  [[nodiscard]] const Reader& file(std::size_t index) const { return *parts_[index].reader; }
  void join(const FileList& files);
  void joinChannels(Part& part);
  void joinCounts(const Part& part);

  std::vector<Part> parts_;
  FileInfo info_;
  std::map<SchemaId, Schema> schemas_;
  std::map<ChannelId, Channel> channels_;
  Statistics statistics_;
  std::vector<AttachmentIndex> attachments_;
  std::vector<std::size_t> attached_to_;  // the file, of each attachment
};

/// Walks through them as MessageCursor does. In log time order messages of equal time come in the order of the files;
/// in file order the files come one after another. A file is read when its time has come.
class JoinedCursor {
 public:
  /// The next message, valid until another is asked for; false at the end. Throws as MessageCursor does.
  [[nodiscard]] bool next(MessageView& message);

 private:
  friend class JoinedReader;
  JoinedCursor(const JoinedReader& reader, const MessageFilter& filter);

  struct Walk {
    const JoinedReader::Part* part = nullptr;
    std::size_t index = 0;
    std::uint64_t time_ns = 0;  // of its next message, or the earliest it can have; 0 in file order
    bool is_read = false;       // `next` is there
    MessageCursor cursor;
    Repeated repeated;
    MessageView next{};
  };
  void queue(Walk* walk);
  [[nodiscard]] bool advance(Walk& walk) const;

  bool by_time_;
  std::vector<std::unique_ptr<Walk>> walks_;
  std::vector<Walk*> queue_;  // a heap, the first one in front
  Walk* current_ = nullptr;   // the one whose message was given last
};

}  // namespace baton::mcap
