/// Writers with accounts of their own, and a ledger that books what arrives of what they send.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "dds/hash.hpp"
#include "runtime/ledger.hpp"

namespace baton::test {

using Json = nlohmann::json;

inline dds::Guid guidOf(std::uint8_t id) {
  dds::Guid guid;
  guid.bytes.fill(id);
  return guid;
}

inline std::vector<std::byte> payloadOf(std::uint64_t number) {
  const auto bytes = std::as_bytes(std::span(&number, 1));
  return {bytes.begin(), bytes.end()};
}

/// One writer of one topic, and its own account of what it sent.
struct Sender {
  std::string topic;
  dds::Guid guid;
  std::uint64_t count = 0;
  std::uint64_t hash = 0;

  std::vector<std::byte> send() {
    std::vector<std::byte> payload = payloadOf(++count);
    hash = dds::chainHash(hash, payload);
    return payload;
  }
  [[nodiscard]] Ledger::Key key() const { return {topic, guid}; }
};

inline msg::ServiceManifest manifestOf(const std::string& service, const std::vector<const Sender*>& senders) {
  msg::ServiceManifest manifest;
  manifest.name(service);
  for (const Sender* sender : senders) {
    msg::StreamManifest stream;
    stream.topic(sender->topic);
    stream.writer(sender->guid.bytes);
    stream.first_sequence(sender->count > 0 ? 1 : 0);
    stream.last_sequence(sender->count);
    stream.count(sender->count);
    stream.stream_hash(sender->hash);
    manifest.streams().push_back(stream);
  }
  return manifest;
}

inline bool mentions(const std::vector<std::string>& sentences, const std::string& words) {
  return std::any_of(sentences.begin(), sentences.end(),
                     [&](const std::string& s) { return s.find(words) != std::string::npos; });
}

class LedgerTest : public testing::Test {
 protected:
  /// Sends `count` samples and books those that `arrives` lets through.
  template <class Arrives>
  void transmit(Sender& sender, std::uint64_t count, Arrives arrives) {
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::vector<std::byte> payload = sender.send();
      if (!arrives(sender.count)) continue;
      EXPECT_TRUE(ledger_.book(sender.key(), sender.count, payload)) << sender.count;
    }
  }
  void transmit(Sender& sender, std::uint64_t count) {
    transmit(sender, count, [](std::uint64_t) { return true; });
  }
  [[nodiscard]] Json certificate() const { return Json::parse(ledger_.certificate()); }

  Sender state_{"plant_state", guidOf(1)};
  Sender status_{"sim_status", guidOf(2)};
  Sender contact_{"contact", guidOf(3)};
  Ledger ledger_{{"plant", "environment"}};
};

}  // namespace baton::test
