/// One recording on the disk: a file, or several parts of one, with what the run is of in each and the certificate in
/// the last. Each part stands for itself: schemas, channels, scenario and robot are in it. A sample is in exactly one.
///
/// One thread at a time. Nothing is allocated for a sample once a part has seen its writer.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "certificate.hpp"
#include "mcap/writer.hpp"
#include "runtime/latched.hpp"
#include "storage_policy.hpp"

namespace baton {

struct Attachment {
  std::string name;
  std::string media_type;
  std::string text;
};

/// What a run is of, as each part says at its beginning.
struct Origin {
  mcap::StringMap run;
  std::vector<Attachment> attachments;
};

/// A sample that late joiners would be given, as a file that begins in the middle repeats it.
struct LatchedHead {
  const Stream* stream = nullptr;
  std::uint64_t sequence = 0;
  std::int64_t source_timestamp_ns = 0;
};
using Latched = LatchedSamples<LatchedHead>;
/// Payloads of those that a recording's files may begin with.
inline constexpr std::size_t kMostLatchedBytes = std::size_t{16} << 20;
inline constexpr std::size_t kMostForeignLatchedBytes = std::size_t{64} << 20;
inline constexpr const char* kForeignGivenUp =
    "the latest samples for late joiners of foreign topics take more than 64 MB: a file that begins later does not "
    "begin "
    "with all of them";

class Recording {
 public:
  /// Creates the first part. `config`, `origin` and `latched` outlive the recording. Each part begins with
  /// what there is in `latched`, with the log time of its first sample: these are not in its accounts. Throws
  /// UnavailableError when the file is there already or cannot be created.
  Recording(std::filesystem::path path, const RecordingConfig& config, const Origin& origin, std::uint64_t elapsed,
            std::uint64_t from_step, const Latched* latched = nullptr);

  struct Sample {
    std::uint64_t sequence = 0;
    std::int64_t log_time_ns = 0;
    std::int64_t source_timestamp_ns = 0;
    std::uint64_t lost_before = 0;  // samples of its writer that should have come before it
    std::span<const std::byte> payload;
  };
  /// Throws WriteError.
  void write(const Stream& stream, const Sample& sample);
  void flush() { file_->flush(); }
  void sync() { file_->sync(); }
  /// Goes on in another part when this one is full. @param elapsed  steps of the run so far.  @param step  of the
  /// state.
  void splitWhenFull(std::uint64_t elapsed, std::uint64_t step);
  /// All but what is left on the disk.
  [[nodiscard]] Storage storage() const;
  void dropOldestPart();

  /// The last part is finished, with the certificate; nothing is written any more. @param holes  beside those that
  /// dropped parts have left.
  void finish(Certificate& certificate, std::uint64_t to_step, const std::vector<Hole>& holes,
              const std::vector<Attachment>& attachments);

  /// Whether anything of it is here.
  [[nodiscard]] bool holds(const Stream& stream) const {
    return stream.index < written_.size() && written_[stream.index].stream != nullptr;
  }
  /// How many are missing between the first and the last of it that are here.
  [[nodiscard]] std::uint64_t missing(const Stream& stream) const {
    return holds(stream) ? written_[stream.index].recorded.missing : 0;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Of those that are there.
  [[nodiscard]] const std::filesystem::path& firstPart() const { return parts_.front().path; }
  [[nodiscard]] unsigned part() const { return index_; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  /// Of these, those that no end of this process can take away any more.
  [[nodiscard]] std::uint64_t writtenMessages() const;
  [[nodiscard]] std::uint64_t bytes() const { return closed_bytes_ + (file_ ? file_->statistics().file_bytes : 0); }

 private:
  /// How a stream stood when a part got the first of it.
  struct Share {
    std::size_t stream = 0;
    std::uint64_t first_sequence = 0;
    std::uint64_t count_before = 0;
    std::uint64_t missing_before = 0;
    std::uint64_t hash_before = 0;
  };
  struct Part {
    std::filesystem::path path;
    std::uint64_t bytes = 0;
    std::uint64_t from_step = 0;
    std::uint64_t messages_before = 0;
    std::vector<Share> shares;
  };
  struct Written {
    const Stream* stream = nullptr;
    RecordedStream recorded;
    mcap::ChannelId channel{};  // in this part; 0: none yet
    bool is_here = false;       // a sample is in this part, not only what it repeats
    std::uint64_t dropped = 0;  // of the count, in parts that are gone
    std::uint64_t dropped_missing = 0;
  };

  [[nodiscard]] std::unique_ptr<mcap::Writer> openPart(unsigned index, std::uint64_t from_step) const;
  [[nodiscard]] std::unique_ptr<mcap::Writer> openFile(const std::filesystem::path& path, unsigned index,
                                                       std::uint64_t from_step) const;
  [[nodiscard]] Written& writtenOf(const Stream& stream);
  void begin(Written& written, const Stream& stream, const Sample& sample);
  void openChannel(Written& written, const Stream& stream);
  void repeat(std::int64_t log_time_ns);
  void closeFile();

  std::filesystem::path path_;
  const RecordingConfig& config_;
  const Origin& origin_;
  unsigned index_ = 0;
  std::deque<Part> parts_;  // that are there; the last one is being written
  std::unique_ptr<mcap::Writer> file_;
  std::vector<Written> written_;  // by the stream's index
  std::optional<Hole> dropped_;   // where the oldest parts were
  std::uint64_t messages_ = 0;
  std::uint64_t closed_bytes_ = 0;
  const Latched* latched_;
  bool has_begun_ = false;           // this part
  mcap::WriterStatistics repeated_;  // how it stood when it had repeated all
  std::uint64_t part_elapsed_ = 0;   // of the run, when the part began
  std::uint64_t from_step_ = 0;
};

}  // namespace baton
