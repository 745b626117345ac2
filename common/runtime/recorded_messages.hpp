/// One topic of a recording, decoded.
#pragma once

#include <cstdint>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/source.hpp"

namespace baton {

/// Calls f(message, view) for every message of the topic that can be decoded, in the file's order, from a log time on.
/// Throws what reading a recording throws.
template <class T, class F>
void forEachMessageOf(const dds::Topic<T>& topic, const mcap::Source& reader, std::uint64_t begin_ns, const F& f) {
  T message;
  reader.forEachMessage({.topics = {topic.name}, .start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile},
                        [&](const mcap::MessageView& view) {
                          if (dds::decode(view.data, message)) f(message, view);
                        });
}

}  // namespace baton
