#include "support/recordings.hpp"

#include <set>

namespace baton::test {

Streams readStreams(const std::string& file) {
  const mcap::Reader reader(file);
  Streams streams;
  reader.forEachMessage({}, [&](const mcap::MessageView& message) {
    streams[{message.channel->topic, message.channel->metadata.at("service")}].emplace_back(message.data.begin(),
                                                                                            message.data.end());
  });
  return streams;
}

Streams loopStreams(const std::string& file) {
  static const std::set<std::string> kLoop{"plant_state", "contact", "reference", "joint_command", "shadow_command"};
  Streams streams = readStreams(file);
  std::erase_if(streams, [](const auto& entry) { return !kLoop.contains(entry.first.first); });
  return streams;
}

}  // namespace baton::test
