// Fuzz target: a byte that chooses a topic, and a payload, decoded as a service decodes what arrives there. What is a
// message is encoded and decoded again to the same bytes, and the loop's signals in it are read.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <tuple>
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

constexpr std::tuple kTopics{dds::topics::kPlantState,      dds::topics::kPlantStateAgain,
                             dds::topics::kContact,         dds::topics::kReference,
                             dds::topics::kJointCommand,    dds::topics::kShadowCommand,
                             dds::topics::kCheckpoint,      dds::topics::kSimRequest,
                             dds::topics::kSimReply,        dds::topics::kSimStatus,
                             dds::topics::kRewind,          dds::topics::kRewindAck,
                             dds::topics::kTimingStatus,    dds::topics::kSwapRequest,
                             dds::topics::kSwapPlan,        dds::topics::kSwapAck,
                             dds::topics::kSwapOutcome,     dds::topics::kSwapReport,
                             dds::topics::kBatonStatus,     dds::topics::kControllerStatus,
                             dds::topics::kParameterStatus, dds::topics::kParameterRequest,
                             dds::topics::kParameterReply,  dds::topics::kDecision,
                             dds::topics::kLaunchRequest,   dds::topics::kLaunchReply,
                             dds::topics::kServiceStatus,   dds::topics::kServiceManifest,
                             dds::topics::kEvent,           dds::topics::kRecorderStatus,
                             dds::topics::kRecordRequest,   dds::topics::kRecordReply,
                             dds::topics::kReplayStatus,    dds::topics::kReplayRequest,
                             dds::topics::kReplayReply};
static_assert(std::tuple_size_v<decltype(kTopics)> == dds::topics::kAll.size(), "a topic is missing here");

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::byte> payload = std::as_bytes(std::span(data, size)).subspan(1);
  std::size_t left = data[0] % dds::topics::kAll.size();
  const auto receiveIfChosen = [&](const auto& topic) {
    if (left-- == 0) receive(topic, payload);
  };
  std::apply([&](const auto&... topic) { (receiveIfChosen(topic), ...); }, kTopics);
  return 0;
}
