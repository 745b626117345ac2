// Fuzz target: a byte that chooses a topic, and a payload, decoded as a service decodes what arrives there. What is a
// message is encoded and decoded again to the same bytes, and the loop's signals in it are read.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "messages/loop.hpp"
#include "messages/values.hpp"

namespace {

using namespace baton;

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Message, class Signal>
void readSignal(const Message& message, Signal& signal) {
  for (int n = 1; n <= kMaxJoints; ++n) {
    if (fromMessage(message, n, signal)) return;
  }
}
template <class Message>
void readSignals(const Message& /*has none*/) {}
void readSignals(const msg::PlantState& message) {
  RobotState state;
  readSignal(message, state);
}
void readSignals(const msg::Contact& message) {
  Contact contact;
  (void)fromMessage(message, contact);
}
void readSignals(const msg::Reference& message) {
  Reference reference;
  readSignal(message, reference);
}
void readSignals(const msg::JointCommand& message) {
  JointVector effort;
  readSignal(message, effort);
}

template <class T>
void receive(const dds::Topic<T>& /*topic*/, std::span<const std::byte> payload) {
  T message, again;
  if (!dds::decode(payload, message)) return;
  std::vector<std::byte> first(dds::maxPayload<T>()), second(dds::maxPayload<T>());
  const auto encoded = dds::encode(message, std::span(first));
  require(!encoded.empty());  // every bound was checked
  require(dds::decode(encoded, again));
  const auto repeated = dds::encode(again, std::span(second));
  require(std::ranges::equal(encoded, repeated));
  readSignals(message);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::byte> payload = std::as_bytes(std::span(data, size)).subspan(1);
  std::size_t left = data[0] % dds::topics::kAll.size();
  const auto receiveIfChosen = [&](const auto& topic) {
    if (left-- == 0) receive(topic, payload);
  };
  dds::topics::forEach(receiveIfChosen);
  return 0;
}
