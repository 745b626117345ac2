#include "mcap/repeated.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "mcap/lookup.hpp"
#include "mcap/readable_metadata.hpp"
#include "mcap/reader.hpp"

namespace baton::mcap {
namespace {

constexpr const char* kCount = "messages";

/// What the file claims; whoever merged files may have kept the word of one of them, so it is checked below.
std::uint64_t claimOf(const Reader& file) {
  for (const Metadata& one : readableMetadata(file)) {
    if (one.name != kRepeatedRecord) continue;
    const std::string text = valueOf(one.values, kCount);
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    return error == std::errc() && end == text.data() + text.size() ? count : 0;
  }
  return 0;
}

/// What a channel is, whatever its numbers in the file.
auto meaningOf(const Channel& channel, const Schema* schema) {
  static const Schema kNone{};
  const Schema& type = schema != nullptr ? *schema : kNone;
  return std::tie(channel.topic, channel.message_encoding, channel.metadata, type.name, type.encoding, type.data);
}

/// Which messages a file has of the channels of another one, by their times.
class Holding {
 public:
  explicit Holding(const Reader& file) : file_(file) {}

  [[nodiscard]] bool has(const MessageView& message) {
    if (message.publish_time_ns > file_.statistics().end_time_ns) return false;
    const auto [known, is_new] = same_.try_emplace(message.channel->id);
    if (is_new) known->second = sameAs(message);
    if (!known->second) return false;
    if (message.publish_time_ns >= file_.statistics().start_time_ns) return true;
    // From before the file: given to whoever recorded it when they joined, or repeated there.
    return beginOf(*known->second) <= message.publish_time_ns;
  }

 private:
  /// The same channel in this file, when it has messages.
  [[nodiscard]] std::optional<ChannelId> sameAs(const MessageView& message) const {
    const auto& counts = file_.statistics().channel_message_counts;
    for (const auto& [id, channel] : file_.channels()) {
      const auto schema = file_.schemas().find(channel.schema_id);
      const Schema* type = schema == file_.schemas().end() ? nullptr : &schema->second;
      const bool is_same = meaningOf(channel, type) == meaningOf(*message.channel, message.schema);
      if (const auto count = counts.find(id); is_same && count != counts.end() && count->second > 0) return id;
    }
    return std::nullopt;
  }
  /// When the first message of a channel was published.
  [[nodiscard]] std::uint64_t beginOf(ChannelId channel) {
    const auto [known, is_new] = begins_ns_.try_emplace(channel, std::numeric_limits<std::uint64_t>::max());
    if (is_new) {
      MessageCursor messages = file_.messages({.channels = {channel}});
      if (MessageView first; messages.next(first)) known->second = first.publish_time_ns;
    }
    return known->second;
  }

  const Reader& file_;
  std::map<ChannelId, std::optional<ChannelId>> same_;  // by the other file's channel
  std::map<ChannelId, std::uint64_t> begins_ns_;
};

}  // namespace

template <class IsMeant>
void Repeated::read(const Reader& file, const IsMeant& is_meant) {
  const std::uint64_t claim = claimOf(file);
  if (claim == 0) return;
  log_time_ns_ = file.statistics().start_time_ns;
  std::uint64_t passed = 0;
  MessageCursor beginning = file.messages({.end_time_ns = log_time_ns_, .order = MessageFilter::Order::kFile});
  for (MessageView message; passed < claim && beginning.next(message); ++passed) {
    const bool is_one = is_meant(message);
    beginnings_[message.channel->id].is_meant.push_back(is_one);
    if (!is_one) continue;
    ++count_;
    ++counts_[message.channel->id];
  }
}

Repeated::Repeated(const Reader& file) {
  read(file, [](const MessageView&) { return true; });
}

Repeated::Repeated(const Reader& file, const std::vector<const Reader*>& before) {
  std::vector<Holding> holdings;
  holdings.reserve(before.size());
  for (const Reader* one : before) holdings.emplace_back(*one);
  read(file, [&](const MessageView& message) {
    return std::ranges::any_of(holdings, [&](Holding& one) { return one.has(message); });
  });
}

bool Repeated::takes(const MessageView& message) {
  if (message.log_time_ns != log_time_ns_) return false;
  const auto found = beginnings_.find(message.channel->id);
  if (found == beginnings_.end()) return false;
  Beginning& beginning = found->second;
  return beginning.passed < beginning.is_meant.size() && beginning.is_meant[beginning.passed++];
}

StringMap repeatedRecord(std::uint64_t messages) { return {{kCount, std::to_string(messages)}}; }

}  // namespace baton::mcap
