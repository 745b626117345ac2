/// What a late joiner is given: of each writer whose topic is transient local the latest samples, as many as the writer
/// keeps, of each instance. A replay, a cut, a part of a split recording and a ring that begin in the middle begin with
/// these.
///
/// A reset of the run parts what is kept: its announcement is kept as well, although its topic is volatile, since a
/// file that begins after it would not know of which take it is; what was decided in takes before it is kept no more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mcap/source.hpp"

namespace baton::dds {
struct TopicFacts;
}

namespace baton {

/// How many samples of an instance a recorded writer kept for late joiners, by its topic and its channel's metadata: of
/// Baton's topics what their profile says, but none of requests other than to launch, and one of resets; of others the
/// depth in the recorded QoS, and the last one where that says transient local without a depth. 0 for none.
[[nodiscard]] std::size_t latchedDepth(const std::string& topic, const mcap::StringMap& metadata);

/// The facts of a topic of Baton by its name and its type, which is in the channel's metadata; null for any other.
[[nodiscard]] const dds::TopicFacts* batonTopic(const std::string& topic, const mcap::StringMap& metadata);

/// Of samples of Baton's topics, with the facts that batonTopic() gives; null says nothing of resets.
[[nodiscard]] bool announcesReset(const dds::TopicFacts* topic);
/// The take that begins with this sample; nothing when it commits no reset.
[[nodiscard]] std::optional<std::uint32_t> takeBegunBy(const dds::TopicFacts* topic, mcap::ByteView bytes);
/// Whether a sample that came before this take began was of a take before it, and says nothing of this one.
[[nodiscard]] bool isOfTakeBefore(std::uint32_t take, const dds::TopicFacts* topic, mcap::ByteView bytes);

/// Keeps them while samples go by. @tparam Head  what is known of a sample, without its bytes.
template <class Head>
class LatchedSamples {
 public:
  struct Sample {
    Head head{};
    std::vector<std::byte> bytes{};
  };

  /// @param max_bytes  of payloads; beyond it the oldest go of those that are not the latest of their instance.
  /// @param max_foreign_bytes  when given, of topics that are none of Baton's, which then do not count among the
  /// others: beyond it also a latest one is not kept.
  explicit LatchedSamples(std::size_t max_bytes, std::optional<std::size_t> max_foreign_bytes = {})
      : max_bytes_(max_bytes), max_foreign_bytes_(max_foreign_bytes) {}

  /// @param depth  of the stream's history; nothing is kept for 0.
  /// @param topic  when it is one of Baton's: of resets only a commit is kept, and what it ends goes.
  void keep(std::size_t stream, const std::string& instance, std::size_t depth, const Head& head, mcap::ByteView bytes,
            const dds::TopicFacts* topic = nullptr) {
    if (depth == 0) return;
    if (announcesReset(topic)) {
      const std::optional<std::uint32_t> take = takeBegunBy(topic, bytes);
      if (!take) return;
      forgetTakesBefore(*take);
    }
    const Key key{stream, instance};
    History& history = histories_[key];
    if (!history.empty()) superseded_.emplace(history.back()->number, history.back());
    samples_.push_back({{head, {bytes.begin(), bytes.end()}}, key, topic, ++last_number_});
    history.push_back(std::prev(samples_.end()));
    bytes_ += bytes.size();
    if (topic == nullptr) foreign_bytes_ += bytes.size();
    while (history.size() > depth) drop(history.front());
    while (topic == nullptr && max_foreign_bytes_ && foreign_bytes_ > *max_foreign_bytes_ && !history.empty()) {
      if (history.size() == 1) ++given_up_;
      drop(history.front());
    }
    while (bytes_ - (max_foreign_bytes_ ? foreign_bytes_ : 0) > max_bytes_ && !superseded_.empty())
      drop(superseded_.begin()->second);
  }
  /// Calls f(sample) in the order in which they were kept.
  template <class F>
  void forEach(const F& f) const {
    for (const Kept& one : samples_) f(one.sample);
  }
  void clear() {
    samples_.clear();
    histories_.clear();
    superseded_.clear();
    bytes_ = foreign_bytes_ = 0;
  }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Latest samples of foreign topics that were not kept.
  [[nodiscard]] std::size_t givenUp() const { return given_up_; }

 private:
  using Key = std::pair<std::size_t, std::string>;  // stream, instance
  struct Kept {
    Sample sample;
    Key key;
    const dds::TopicFacts* topic;
    std::uint64_t number;  // in the order in which they were kept
  };
  using Place = typename std::list<Kept>::iterator;
  using History = std::deque<Place>;

  void forgetTakesBefore(std::uint32_t take) {
    for (Place one = samples_.begin(); one != samples_.end();) {
      const Place next = std::next(one);
      if (isOfTakeBefore(take, one->topic, one->sample.bytes)) drop(one);
      one = next;
    }
  }
  void drop(Place kept) {
    History& history = histories_.at(kept->key);
    if (history.front() == kept) {
      history.pop_front();
    } else {
      std::erase(history, kept);
    }
    if (!history.empty()) superseded_.erase(history.back()->number);  // where it is the latest now
    superseded_.erase(kept->number);
    bytes_ -= kept->sample.bytes.size();
    if (kept->topic == nullptr) foreign_bytes_ -= kept->sample.bytes.size();
    samples_.erase(kept);
  }

  std::size_t max_bytes_;
  std::optional<std::size_t> max_foreign_bytes_;
  std::size_t bytes_ = 0, foreign_bytes_ = 0;
  std::size_t given_up_ = 0;
  std::list<Kept> samples_;
  std::map<Key, History> histories_;
  std::map<std::uint64_t, Place> superseded_;  // those that may go, by number: of their instance there is a later one
  std::uint64_t last_number_ = 0;
};

/// A message that is given again; what it points at belongs to the reader.
struct LatchedMessage {
  mcap::MessageView view;  // its data lies in `bytes`
  std::vector<std::byte> bytes;
};

/// Those that a late joiner would have been given right before the filter's first time, of the filter's channels, in
/// the order of their log times. Empty where the recording begins no earlier. Reads the recording up to there. Throws
/// what reading a recording throws.
[[nodiscard]] std::vector<LatchedMessage> latchedBefore(const mcap::Source& reader, const mcap::MessageFilter& filter);

}  // namespace baton
