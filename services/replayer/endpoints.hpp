/// The writer that stands in for a recorded one.
#pragma once

#include <map>
#include <string>

#include "dds/endpoint.hpp"
#include "mcap/records.hpp"

namespace baton {

/// Topic, type and QoS of a recorded channel, from its metadata "type", "qos" and "qos_policies" and its schema (may be
/// null). The QoS are the original's, as far as a reader can demand them: reliability, durability, deadline,
/// liveliness, ownership. Who matched the original matches its replay, and nobody else. What is not recorded is
/// promised: reliable, and lasting for late joiners. Two things are not the original's. A lifespan would end what is
/// sent with its old timestamp before anybody reads it; and how many samples the writer kept for late joiners is in no
/// discovery data. Throws UsageError when the channel cannot go out on DDS: it is not CDR, or topic or type have no
/// name that DDS can carry.
[[nodiscard]] dds::EndpointOptions replayEndpoint(const mcap::Channel& channel, const mcap::Schema* schema,
                                                  const std::map<std::string, std::string>& remap);

/// Why the writers of a topic cannot all be on DDS together: a topic has one type there, with a key or without. By
/// topic; empty when they can.
[[nodiscard]] std::map<std::string, std::string> contradictions(
    const std::map<mcap::ChannelId, dds::EndpointOptions>& endpoints);

}  // namespace baton
