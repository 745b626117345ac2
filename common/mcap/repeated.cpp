#include "mcap/repeated.hpp"

#include <algorithm>
#include <charconv>

#include "mcap/lookup.hpp"

namespace baton::mcap {
namespace {

constexpr const char* kCount = "messages";

/// What the file claims; whoever merged files may have kept the word of one of them, so it is checked below.
std::uint64_t claimOf(const Source& file) {
  for (const Metadata& one : file.metadata()) {
    if (one.name != kRepeatedRecord) continue;
    const std::string text = valueOf(one.values, kCount);
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    return error == std::errc() && end == text.data() + text.size() ? count : 0;
  }
  return 0;
}

}  // namespace

Repeated::Repeated(const Source& file) {
  const std::uint64_t claim = claimOf(file);
  if (claim == 0) return;
  log_time_ns_ = file.statistics().start_time_ns;
  const MessageFilter beginning{.end_time_ns = log_time_ns_, .order = MessageFilter::Order::kFile};
  file.forEachMessage(beginning, [&](const MessageView& message) {
    if (count_ == claim) return;
    ++count_;
    ++left_[message.channel->id];
  });
}

bool Repeated::takes(const MessageView& message) {
  if (message.log_time_ns != log_time_ns_) return false;
  const auto left = left_.find(message.channel->id);
  if (left == left_.end() || left->second == 0) return false;
  --left->second;
  return true;
}

StringMap repeatedRecord(std::uint64_t messages) { return {{kCount, std::to_string(messages)}}; }

}  // namespace baton::mcap
