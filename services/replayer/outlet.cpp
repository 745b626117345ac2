#include "outlet.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <fstream>

#include "base/error.hpp"
#include "base/plural.hpp"
#include "sleeper.hpp"

namespace baton {
namespace {

/// What the kernel counts against a socket's buffer for a small datagram beside its payload.
constexpr std::uint64_t kDatagramBytes = 1280;
/// The receive buffer that Baton's processes ask for, and get where the kernel's limit is not lower.
constexpr std::uint64_t kSocketBuffer = 4 << 20;
constexpr int kLook_ms = 100;
constexpr std::int64_t kTellAfter_ns = 5'000'000'000;      // of waiting for a reader to acknowledge
constexpr std::int64_t kDeafAfter_ns = 30'000'000'000;     // longer than discovery takes to notice a death
constexpr std::int64_t kNextDeafAfter_ns = 3'000'000'000;  // once there was one: most likely they are the same process

/// How much may be on its way before readers must acknowledge. What overflows a reader's socket is lost, and a reader
/// keeps too few samples to wait long for one to be sent again.
std::uint64_t windowBytes() {
  std::uint64_t limit = 212'992;  // the kernel's own default
  std::ifstream("/proc/sys/net/core/rmem_max") >> limit;
  return std::min(limit, kSocketBuffer);
}

}  // namespace

Outlet::Outlet(dds::Participant& participant, const std::map<mcap::ChannelId, dds::EndpointOptions>& endpoints,
               std::function<bool()> keep_waiting)
    : participant_(participant), keep_waiting_(std::move(keep_waiting)), window_(windowBytes()) {
  for (const auto& [id, endpoint] : endpoints) {
    try {
      lines_.try_emplace(id, participant, endpoint);
    } catch (const Error& error) {  // of QoS that contradict each other, say
      refused_[id] = error.what();
    }
  }
}

bool Outlet::write(const mcap::MessageView& message) {
  Line& line = lines_.at(message.channel->id);
  if (!line.writer.write(message.data, static_cast<std::int64_t>(message.publish_time_ns))) {
    if (line.refused++ == 0) line.first_refused = message.data.size();
    return false;
  }
  in_flight_ += message.data.size() + kDatagramBytes;
  return true;
}

std::vector<std::string> Outlet::problems() const {
  std::vector<std::string> all;
  for (const auto& [id, line] : lines_) {
    if (line.refused == 0) continue;
    all.push_back("topic " + line.topic + ": DDS refused " + counted(line.refused, "message") + ", the first of " +
                  counted(line.first_refused, "byte"));
  }
  return all;
}

void Outlet::spareReaders(bool is_hurried) {
  if (!is_hurried) in_flight_ = 0;
  if (in_flight_ >= window_) waitForAcknowledgments();
}

void Outlet::waitForAcknowledgments() {
  const std::int64_t since_ns = steadyNow(), limit_ns = deaf_.empty() ? kDeafAfter_ns : kNextDeafAfter_ns;
  bool has_told = false;
  for (auto& [id, line] : lines_) {
    while (!line.is_deaf && !line.writer.waitForAcknowledgments(kLook_ms)) {
      if (!keep_waiting_()) return;
      const std::int64_t waited_ns = steadyNow() - since_ns;
      if (waited_ns > limit_ns) {
        deaf_.push_back("a reader of " + line.topic + " does not acknowledge: it is no longer waited for");
        spdlog::warn("{}", deaf_.back());
        line.is_deaf = true;
      } else if (waited_ns > kTellAfter_ns && !has_told) {
        has_told = true;
        spdlog::info("waiting for a reader of {} to acknowledge", line.topic);
      }
    }
  }
  in_flight_ = 0;
}

Readers Outlet::readers() const {
  Readers readers;
  for (const auto& [id, line] : lines_) {
    auto& processes = readers.emplace(line.topic, Readers::mapped_type{})->second;
    for (const dds::GuidPrefix& prefix : line.writer.matched()) {
      auto peer = participant_.peer(prefix);
      if (!peer) peer = participant_.stranger(prefix);  // listeners need no key
      processes.emplace(prefix, peer ? peer->service : "");
    }
  }
  return readers;
}

std::size_t Outlet::topics() const {
  std::set<std::string> names;
  for (const auto& [id, line] : lines_) names.insert(line.topic);
  return names.size();
}

}  // namespace baton
