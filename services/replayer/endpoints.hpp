/// The writer that stands in for a recorded one.
#pragma once

#include <map>
#include <string>

#include "dds/endpoint.hpp"
#include "mcap/records.hpp"

namespace baton {

/// Topic, type and QoS of a recorded channel, from its metadata "type" and "qos" and its schema (may be null). The QoS
/// promise at least what the original did: always reliable, and lasting for late joiners unless the recording says
/// volatile, so that every reader of the original matches.
/// Throws UsageError when the channel cannot go out on DDS: it is not CDR, or has no type.
[[nodiscard]] dds::EndpointOptions replayEndpoint(const mcap::Channel& channel, const mcap::Schema* schema,
                                                  const std::map<std::string, std::string>& remap);

}  // namespace baton
