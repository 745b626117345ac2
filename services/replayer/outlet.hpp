/// The writers that stand in for the recorded ones, and how much they may have on its way.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "audience.hpp"
#include "dds/endpoint.hpp"
#include "mcap/cursor.hpp"

namespace baton {

class Outlet {
 public:
  /// @param keep_waiting  called about ten times a second while readers are waited for; false gives up.
  /// A writer that DDS refuses is missing, and named in refused().
  Outlet(dds::Participant& participant, const std::map<mcap::ChannelId, dds::EndpointOptions>& endpoints,
         std::function<bool()> keep_waiting);

  /// Sends a message with the source timestamp it had. Returns false, and counts it for problems(), when DDS refuses
  /// it.
  bool write(const mcap::MessageView& message);
  /// Waits now and then for readers that are slower than a replay in a hurry: they would lose messages. At the recorded
  /// rate they keep up as those of the original did, and waiting for them would cost the rhythm.
  void spareReaders(bool is_hurried);
  /// Waits until the readers have everything. One that was killed is waited for until discovery gives it up; those that
  /// live and do not acknowledge, all together not for long.
  void waitForAcknowledgments();

  [[nodiscard]] Readers readers() const;
  [[nodiscard]] std::size_t topics() const;
  [[nodiscard]] std::size_t writers() const { return lines_.size(); }
  /// Channels without a writer, and why.
  [[nodiscard]] const std::map<mcap::ChannelId, std::string>& refused() const { return refused_; }
  /// Messages that DDS refused.
  [[nodiscard]] std::vector<std::string> problems() const;
  /// Readers that are no longer waited for: anybody may be one.
  [[nodiscard]] const std::vector<std::string>& deaf() const { return deaf_; }

 private:
  struct Line {
    Line(dds::Participant& participant, const dds::EndpointOptions& options)
        : topic(options.topic), writer(participant, options) {}
    std::string topic;
    dds::RawWriter writer;
    bool is_deaf = false;           // a reader of it does not acknowledge
    std::uint64_t refused = 0;      // messages
    std::size_t first_refused = 0;  // bytes of the first of them
  };

  dds::Participant& participant_;
  std::function<bool()> keep_waiting_;
  std::map<mcap::ChannelId, Line> lines_;
  std::map<mcap::ChannelId, std::string> refused_;
  std::uint64_t window_;         // bytes that may be on their way
  std::uint64_t in_flight_ = 0;  // since the last acknowledgment
  std::vector<std::string> deaf_;
};

}  // namespace baton
