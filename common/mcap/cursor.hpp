/// Walks through the messages of a recording, one after another.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "mcap/extent.hpp"

namespace baton::mcap {

struct MessageFilter {
  enum class Order {
    kLogTime,  // never decreasing; at equal times as in the file. Chunks that overlap in time are held together
    kFile,     // as written; one chunk is held at a time
  };
  std::vector<ChannelId> channels{};  // these channels and the channels
  std::vector<std::string> topics{};  // of these topics; all when both are empty
  std::uint64_t start_time_ns = 0;    // log times from start to end, both included
  std::uint64_t end_time_ns = std::numeric_limits<std::uint64_t>::max();
  Order order = Order::kLogTime;
};

/// A message in place: `data` is valid until the next message is asked for, the pointers as long as the Reader.
struct MessageView {
  const Channel* channel = nullptr;
  const Schema* schema = nullptr;  // null when the channel has none
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::uint64_t publish_time_ns = 0;
  ByteView data{};
};

/// Made by Reader::messages(), which must outlive it. Several may walk the same file at once.
class MessageCursor {
 public:
  MessageCursor(const InputFile& file, const FileIndex& index, const ReaderOptions& options,
                const MessageFilter& filter);

  /// The next message; false at the end. Throws FormatError, naming the place, at a damaged chunk, unless
  /// ReaderOptions::on_damage takes it.
  [[nodiscard]] bool next(MessageView& message);

 private:
  struct Route {  // [channel id]
    const Channel* channel = nullptr;
    const Schema* schema = nullptr;
    bool is_wanted = false;
  };
  struct Entry {
    std::uint64_t log_time_ns;
    std::size_t offset;  // of the message's body in the records
    std::size_t length;
    ChannelId channel;  // in the index
  };
  struct LoadedExtent {
    Buffer storage;
    ByteView records;
    std::vector<Entry> entries;  // the wanted messages, in the order of delivery
    std::size_t position = 0;
  };
  struct Candidate {
    std::uint64_t time_ns;  // of its next message, or the earliest it can have; 0 in file order
    std::size_t extent;
    std::unique_ptr<LoadedExtent> loaded;  // null until its turn comes
    bool operator<(const Candidate& other) const {
      return time_ns != other.time_ns ? time_ns < other.time_ns : extent < other.extent;
    }
  };

  [[nodiscard]] std::uint64_t keyTime(std::uint64_t log_time_ns) const;
  void queue(Candidate candidate);
  [[nodiscard]] Candidate takeFirst();
  void load(Candidate& candidate);
  void collect(const Extent& extent, LoadedExtent& loaded) const;

  const FileIndex& index_;
  MessageFilter filter_;
  ExtentLoader loader_;
  std::vector<Route> routes_;
  std::vector<Candidate> queue_;                      // a heap, the first one in front
  Candidate current_{};                               // the extent that delivers; not in the queue
  std::vector<std::unique_ptr<LoadedExtent>> spare_;  // buffers to use again
};

}  // namespace baton::mcap
