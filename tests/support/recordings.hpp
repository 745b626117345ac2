/// A recording, read back for a test: payloads by topic and service, decoded where wanted.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dds/codec.hpp"
#include "mcap/reader.hpp"

namespace baton::test {

using Payload = std::vector<std::byte>;
using Streams = std::map<std::pair<std::string, std::string>, std::vector<Payload>>;  // topic, service

/// All payloads in the order of each writer.
[[nodiscard]] Streams readStreams(const std::string& file);

/// The streams of the control loop alone: those that must repeat byte for byte.
[[nodiscard]] Streams loopStreams(const std::string& file);

/// The messages of one stream. Throws when one does not decode.
template <class T>
[[nodiscard]] std::vector<T> decodeStream(const std::vector<Payload>& payloads) {
  std::vector<T> messages(payloads.size());
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    if (!dds::decode(payloads[i], messages[i])) throw std::runtime_error("a payload does not decode");
  }
  return messages;
}

}  // namespace baton::test
