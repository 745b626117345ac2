/// What a late joiner is given: of each writer whose topic is transient local the latest samples, as many as the writer
/// keeps, of each instance. A replay, a cut, a part of a split recording and a ring that begin in the middle begin with
/// these.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mcap/source.hpp"

namespace baton {

/// How many samples of an instance a recorded writer kept for late joiners, by its topic and its channel's metadata: of
/// Baton's topics what their profile says; of others the depth in the recorded QoS, and the last one where that says
/// transient local without a depth. 0 for none.
[[nodiscard]] std::size_t latchedDepth(const std::string& topic, const mcap::StringMap& metadata);

/// Keeps them while samples go by. @tparam Head  what is known of a sample, without its bytes.
template <class Head>
class LatchedSamples {
 public:
  struct Sample {
    Head head{};
    std::vector<std::byte> bytes{};
  };

  /// @param max_bytes  of payloads; beyond it the oldest go of those that are not the latest of their instance.
  explicit LatchedSamples(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// @param depth  of the stream's history; nothing is kept for 0.
  void keep(std::size_t stream, const std::string& instance, std::size_t depth, const Head& head,
            mcap::ByteView bytes) {
    if (depth == 0) return;
    const Key key{stream, instance};
    History& history = histories_[key];
    samples_.push_back({{head, {bytes.begin(), bytes.end()}}, key});
    history.push_back(std::prev(samples_.end()));
    bytes_ += bytes.size();
    while (history.size() > depth) drop(history.front());
    for (auto oldest = samples_.begin(); bytes_ > max_bytes_ && oldest != samples_.end();) {
      const auto next = std::next(oldest);
      if (histories_.at(oldest->key).size() > 1) drop(oldest);
      oldest = next;
    }
  }
  /// Calls f(sample) in the order in which they were kept.
  template <class F>
  void forEach(const F& f) const {
    for (const Kept& one : samples_) f(one.sample);
  }
  void clear() {
    samples_.clear();
    histories_.clear();
    bytes_ = 0;
  }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  using Key = std::pair<std::size_t, std::string>;  // stream, instance
  struct Kept {
    Sample sample;
    Key key;
  };
  using History = std::deque<typename std::list<Kept>::iterator>;

  void drop(typename std::list<Kept>::iterator kept) {
    histories_.at(kept->key).pop_front();  // its history's oldest, as samples lie in their order
    bytes_ -= kept->sample.bytes.size();
    samples_.erase(kept);
  }

  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::list<Kept> samples_;
  std::map<Key, History> histories_;
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
