#include "endpoints.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_qos.hpp"

namespace baton {
namespace {
using mcap::valueOf;

/// A promise to readers. What comes after less than this nobody keeps: a timer of DDS would only run out without end.
std::int64_t promiseOf(const std::map<std::string, std::string>& qos, const std::string& key) {
  constexpr std::int64_t kShortest_ns = 100'000;
  const auto promised_ns = recordedNumber<std::int64_t>(qos, key);
  return promised_ns == 0 ? 0 : std::max(promised_ns, kShortest_ns);
}

dds::Liveliness livelinessOf(const std::map<std::string, std::string>& qos) {
  using Kind = dds::Liveliness::Kind;
  const std::string kind = valueOf(qos, "liveliness");
  return {.kind = kind == "manual_by_topic"         ? Kind::kManualByTopic
                  : kind == "manual_by_participant" ? Kind::kManualByParticipant
                                                    : Kind::kAutomatic,
          .lease_ns = promiseOf(qos, "lease_ns")};
}

/// Fast DDS cuts a longer name short, and any name at a zero.
void checkName(const std::string& topic, const std::string& what, const std::string& name) {
  constexpr std::size_t kMostBytes = 255;
  if (!name.empty() && name.size() <= kMostBytes && isPlain(name)) return;
  constexpr std::size_t kShown = 60;
  throw UsageError("topic " + escaped(topic.substr(0, kShown)) + ": expected " + what + " of 1 to " +
                   std::to_string(kMostBytes) + " bytes in UTF-8 without control characters, found " +
                   (name.empty() ? "none" : "'" + escaped(name.substr(0, kShown)) + "'") +
                   (name.size() > kShown ? " of " + std::to_string(name.size()) + " bytes" : ""));
}

}  // namespace

dds::EndpointOptions replayEndpoint(const mcap::Channel& channel, const mcap::Schema* schema,
                                    const std::map<std::string, std::string>& remap) {
  if (channel.message_encoding != "cdr") {
    throw UsageError("topic " + channel.topic + ": expected messages in cdr, which DDS carries, found '" +
                     channel.message_encoding + "'");
  }
  std::string type = valueOf(channel.metadata, "type");
  if (type.empty() && schema != nullptr) type = schema->name;
  checkName(channel.topic, "the name of its type", type);
  const std::string new_name = valueOf(remap, channel.topic);
  checkName(channel.topic, "a name", new_name.empty() ? channel.topic : new_name);
  const std::map<std::string, std::string> qos = recordedQos(channel.metadata);
  // Of the lasting profiles kEvent, also for what was a status: it keeps enough to send again whatever gets lost.
  return {.topic = new_name.empty() ? channel.topic : new_name,
          .type = type,
          .profile = valueOf(qos, "durability") == "volatile" ? dds::Profile::kLoop : dds::Profile::kEvent,
          .keyed = valueOf(qos, "keyed") == "true",
          .exclusive_ownership = valueOf(qos, "ownership") == "exclusive",
          .best_effort = valueOf(qos, "reliability") == "best_effort",
          .deadline_ns = promiseOf(qos, "deadline_ns"),
          .liveliness = livelinessOf(qos),
          .ownership_strength = recordedNumber<std::uint32_t>(qos, "ownership_strength")};
}

std::map<std::string, std::string> contradictions(const std::map<mcap::ChannelId, dds::EndpointOptions>& endpoints) {
  std::map<std::string, const dds::EndpointOptions*> firsts;
  std::map<std::string, std::string> found;
  for (const auto& [id, endpoint] : endpoints) {
    const dds::EndpointOptions& first = *firsts.try_emplace(endpoint.topic, &endpoint).first->second;
    if (first.type != endpoint.type) {
      found.try_emplace(endpoint.topic, "topic " + endpoint.topic + ": expected one type, found " + first.type +
                                            " and " + endpoint.type);
    } else if (first.keyed != endpoint.keyed) {
      found.try_emplace(endpoint.topic,
                        "topic " + endpoint.topic + ": expected writers with a key or without, found both");
    }
  }
  return found;
}

}  // namespace baton
