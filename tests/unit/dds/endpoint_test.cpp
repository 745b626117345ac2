/// Readers and writers over real DDS: what is sent is what arrives, to whom it should and to nobody else.
#include "dds/endpoint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <map>
#include <memory>

#include "base/error.hpp"
#include "dds/hash.hpp"
#include "dds/typed.hpp"
#include "full_messages.hpp"
#include "loopback.hpp"

namespace baton::dds {
namespace {

using test::Inbox;
using test::memberOptions;
using test::Received;
using test::Signal;
using Bytes = std::vector<std::byte>;

Bytes copyOf(std::span<const std::byte> payload) { return {payload.begin(), payload.end()}; }

/// Some payload with a header, recognisable by its number.
Bytes payloadOf(std::uint32_t number, std::size_t size = 64) {
  Bytes payload(size, std::byte{0xA5});
  const std::byte header[] = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  std::memcpy(payload.data(), header, sizeof header);
  std::memcpy(payload.data() + sizeof header, &number, sizeof number);
  return payload;
}

EndpointOptions rawOptions(Profile profile, const std::string& topic = "raw") {
  return {.topic = topic, .type = "baton::test::Raw", .profile = profile};
}

class EndpointTest : public testing::Test {
 protected:
  std::unique_ptr<RawReader> reader(Participant& participant, const EndpointOptions& options, Inbox& inbox) {
    return std::make_unique<RawReader>(
        participant, options, [&inbox](const RawSample& sample) { inbox.put(sample); }, [this] { signal_.notify(); });
  }
  std::unique_ptr<RawWriter> writer(Participant& participant, const EndpointOptions& options) {
    return std::make_unique<RawWriter>(participant, options, [this] { signal_.notify(); });
  }
  template <class SomeWriter, class SomeReader>
  [[nodiscard]] bool match(const SomeWriter& w, const SomeReader& r, std::size_t writers = 1, std::size_t readers = 1) {
    return signal_.waitUntil([&] { return w.matched().size() == readers && r.matched().size() == writers; });
  }
  [[nodiscard]] bool waitFor(const Inbox& inbox, std::size_t count) {
    return signal_.waitUntil([&] { return inbox.size() >= count; });
  }

  Signal signal_;
};

TEST_F(EndpointTest, SamplesHaveTheTimeOfTheParticipantsClock) {
  ParticipantOptions options = memberOptions("a", "cell");
  options.clock = WallClock(1'000'000'000'000'000'000);  // which the machine's wall clock need not agree with
  Participant a(options), b(memberOptions("b", "cell"));
  Inbox inbox(signal_);
  const auto r = reader(b, rawOptions(Profile::kEvent), inbox);
  const auto w = writer(a, rawOptions(Profile::kEvent));
  ASSERT_TRUE(match(*w, *r));
  const std::int64_t before = options.clock.now();
  ASSERT_TRUE(w->write(payloadOf(1)));
  const std::int64_t after = options.clock.now();
  ASSERT_TRUE(waitFor(inbox, 1));
  const std::int64_t sent = inbox.samples().at(0).source_timestamp_ns;
  EXPECT_GE(sent, before - 1);  // on the wire stand fractions of 2^-32 s
  EXPECT_LE(sent, after + 1);
  EXPECT_GE(a.self().started_ns, WallClock(1'000'000'000'000'000'000 - 60'000'000'000).now());
}

TEST_F(EndpointTest, WhatATypedWriterSendsArrivesByteByByteInOrder) {
  constexpr std::uint64_t kCount = 500;
  Participant plant(memberOptions("plant", "cell"));
  Participant controller(memberOptions("controller", "cell"));
  Inbox inbox(signal_);
  std::vector<msg::PlantState> decoded;
  Writer<msg::PlantState> out(plant, topics::kPlantState, [this] { signal_.notify(); });
  Reader<msg::PlantState> in(
      controller, topics::kPlantState,
      [&](const msg::PlantState& message, const RawSample& sample) {
        decoded.push_back(message);
        inbox.put(sample);
      },
      [this] { signal_.notify(); });
  ASSERT_TRUE(match(out.raw(), in.raw()));

  std::vector<Bytes> sent;
  auto message = test::full<msg::PlantState>();
  for (std::uint64_t step = 0; step < kCount; ++step) {
    message.step(step);
    message.position().resize(step % (msg::MAX_JOINTS + 1));  // payloads of several sizes
    ASSERT_TRUE(out.write(message));
    sent.push_back(copyOf(out.payload()));
  }
  ASSERT_TRUE(waitFor(inbox, kCount));
  const std::vector<Received> received = inbox.samples();
  ASSERT_EQ(received.size(), kCount);
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(received[i].payload, sent[i]) << i;
    ASSERT_EQ(received[i].sequence, i + 1);
    ASSERT_EQ(received[i].writer, out.raw().guid());
    ASSERT_GT(received[i].source_timestamp_ns, 0);
    ASSERT_EQ(decoded[i].step(), i);
    hash = chainHash(hash, received[i].payload);
  }
  EXPECT_EQ(out.streamHash(), hash);
  EXPECT_EQ(out.raw().count(), kCount);
  EXPECT_EQ(in.rejected(), 0u);
  EXPECT_EQ(in.raw().lost(), 0u);
  EXPECT_TRUE(out.raw().waitForAcknowledgments(30'000));
}

TEST_F(EndpointTest, WhatIsNotAMessageOfTheTypeIsCountedAndDropped) {
  Participant stranger(memberOptions("stranger", "cell"));
  Participant controller(memberOptions("controller", "cell"));
  Inbox inbox(signal_);
  auto out = writer(stranger, endpointOptions(topics::kPlantState));
  Reader<msg::PlantState> in(
      controller, topics::kPlantState, [&](const msg::PlantState&, const RawSample& sample) { inbox.put(sample); },
      [this] { signal_.notify(); });
  ASSERT_TRUE(match(*out, in.raw()));
  Bytes good(maxPayload<msg::PlantState>());
  good = copyOf(encode(test::full<msg::PlantState>(), std::span(good)));
  ASSERT_TRUE(out->write(payloadOf(1)));
  ASSERT_TRUE(out->write(payloadOf(2, 8)));
  ASSERT_TRUE(out->write(good));
  ASSERT_TRUE(waitFor(inbox, 1));
  EXPECT_EQ(inbox.samples().front().payload, good);
  EXPECT_EQ(in.rejected(), 2u);
}

TEST_F(EndpointTest, ReadersInOtherPartitionsAreNotMatched) {
  std::atomic<bool> other_knows_the_writer{false};
  Participant here(memberOptions("here", "cell_a"));
  Participant same(memberOptions("same", "cell_a"));
  Participant other(memberOptions("other", "cell_b"));
  Participant observer(memberOptions("observer", "*"));
  Inbox same_inbox(signal_), other_inbox(signal_), observer_inbox(signal_);
  auto same_reader = reader(same, rawOptions(Profile::kLoop), same_inbox);
  auto other_reader = reader(other, rawOptions(Profile::kLoop), other_inbox);
  auto observer_reader = reader(observer, rawOptions(Profile::kLoop), observer_inbox);
  auto out = writer(here, rawOptions(Profile::kLoop));
  other.watchWriters([&, guid = out->guid()](const DiscoveredWriter& found) {
    if (found.guid == guid) other_knows_the_writer = true;
    signal_.notify();
  });
  ASSERT_TRUE(match(*out, *same_reader, 1, 2));
  ASSERT_TRUE(match(*out, *observer_reader, 1, 2));
  ASSERT_TRUE(signal_.waitUntil([&] { return other_knows_the_writer.load(); }));

  ASSERT_TRUE(out->write(payloadOf(1)));
  ASSERT_TRUE(waitFor(same_inbox, 1));
  ASSERT_TRUE(waitFor(observer_inbox, 1));
  ASSERT_TRUE(out->waitForAcknowledgments(30'000));
  EXPECT_TRUE(other_reader->matched().empty());
  EXPECT_EQ(other_inbox.size(), 0u);
}

TEST_F(EndpointTest, ALateJoinerGetsTheLatestStatus) {
  Participant plant(memberOptions("plant", "cell"));
  auto out = writer(plant, rawOptions(Profile::kStatus));
  for (std::uint32_t i = 1; i <= 3; ++i) ASSERT_TRUE(out->write(payloadOf(i)));
  Participant late(memberOptions("late", "cell"));
  Inbox inbox(signal_);
  auto in = reader(late, rawOptions(Profile::kStatus), inbox);
  ASSERT_TRUE(waitFor(inbox, 1));
  EXPECT_EQ(inbox.samples().front().payload, payloadOf(3));
  EXPECT_EQ(inbox.samples().front().sequence, 3u);
}

TEST_F(EndpointTest, ALateJoinerGetsEveryEvent) {
  constexpr std::uint32_t kCount = 300;
  Participant plant(memberOptions("plant", "cell"));
  auto out = writer(plant, rawOptions(Profile::kEvent));
  for (std::uint32_t i = 1; i <= kCount; ++i) ASSERT_TRUE(out->write(payloadOf(i)));
  Participant late(memberOptions("late", "cell"));
  Inbox inbox(signal_);
  auto in = reader(late, rawOptions(Profile::kEvent), inbox);
  ASSERT_TRUE(waitFor(inbox, kCount));
  const std::vector<Received> received = inbox.samples();
  for (std::uint32_t i = 1; i <= kCount; ++i) {
    ASSERT_EQ(received[i - 1].payload, payloadOf(i));
    ASSERT_EQ(received[i - 1].sequence, i);
  }
}

TEST_F(EndpointTest, ARequestSentBeforeTheMatchIsNotLost) {
  Participant asker(memberOptions("asker", "cell"));
  auto out = writer(asker, rawOptions(Profile::kRequest));
  ASSERT_TRUE(out->write(payloadOf(1)));
  Participant late(memberOptions("late", "cell"));
  Inbox inbox(signal_);
  auto in = reader(late, rawOptions(Profile::kRequest), inbox);
  ASSERT_TRUE(waitFor(inbox, 1));
  EXPECT_EQ(inbox.samples().front().payload, payloadOf(1));
}

TEST_F(EndpointTest, APeerThatGoesIsNoLongerMatched) {
  std::atomic<int> changes{0};
  Participant plant(memberOptions("plant", "cell"), [this](const Peer&) { signal_.notify(); });
  Inbox inbox(signal_);
  auto out = std::make_unique<RawWriter>(plant, rawOptions(Profile::kLoop), [&] {
    ++changes;
    signal_.notify();
  });
  {
    Participant controller(memberOptions("controller", "cell"));
    auto in = reader(controller, rawOptions(Profile::kLoop), inbox);
    auto twin = reader(controller, rawOptions(Profile::kLoop), inbox);
    ASSERT_TRUE(signal_.waitUntil([&] { return changes == 2; }));
    twin.reset();
    ASSERT_TRUE(signal_.waitUntil([&] { return changes == 3; }));
    ASSERT_EQ(out->matched().size(), 1u) << "its other reader is still there";
    const GuidPrefix prefix = *out->matched().begin();
    ASSERT_TRUE(signal_.waitUntil([&] { return plant.peer(prefix).has_value(); }));
    EXPECT_EQ(plant.peer(prefix)->service, "controller");
  }
  EXPECT_TRUE(signal_.waitUntil([&] { return out->matched().empty(); }));
  EXPECT_TRUE(out->write(payloadOf(1))) << "nobody listens, and nothing blocks";
}

TEST_F(EndpointTest, WritersOfOneTopicAreToldApartByGuidAndSequence) {
  constexpr std::uint32_t kCount = 50;
  Participant a(memberOptions("a", "cell")), b(memberOptions("b", "cell")), recorder(memberOptions("recorder", "cell"));
  Inbox inbox(signal_);
  // Events: what is written before the reader has matched all three is not lost.
  auto in = reader(recorder, rawOptions(Profile::kEvent), inbox);
  std::vector<std::unique_ptr<RawWriter>> writers;
  for (Participant* participant : {&a, &a, &b}) writers.push_back(writer(*participant, rawOptions(Profile::kEvent)));
  for (std::uint32_t i = 1; i <= kCount; ++i) {
    for (std::size_t w = 0; w < writers.size(); ++w) {
      ASSERT_TRUE(writers[w]->write(payloadOf(static_cast<std::uint32_t>(1000 * w) + i)));
    }
  }
  ASSERT_TRUE(waitFor(inbox, kCount * writers.size()));
  std::map<Guid, std::uint64_t> next_sequence;
  for (const Received& sample : inbox.samples()) {
    const auto w = static_cast<std::uint32_t>(
        std::find_if(writers.begin(), writers.end(), [&](const auto& x) { return x->guid() == sample.writer; }) -
        writers.begin());
    ASSERT_LT(w, writers.size());
    const std::uint64_t sequence = ++next_sequence[sample.writer];
    EXPECT_EQ(sample.sequence, sequence);
    EXPECT_EQ(sample.payload, payloadOf(1000 * w + static_cast<std::uint32_t>(sequence)));
  }
  EXPECT_EQ(next_sequence.size(), writers.size());
  EXPECT_EQ(in->matched().size(), 2u) << "the writers of one participant count once";
}

TEST_F(EndpointTest, SourceTimestampsOfAReplayAreKept) {
  Participant replayer(memberOptions("replayer", "cell")), viewer(memberOptions("viewer", "cell"));
  Inbox inbox(signal_);
  auto in = reader(viewer, rawOptions(Profile::kLoop), inbox);
  auto out = writer(replayer, rawOptions(Profile::kLoop));
  ASSERT_TRUE(match(*out, *in));
  const std::vector<std::int64_t> times{1, 999'999'999, 1'000'000'000, 1'700'000'000'123'456'789,
                                        1'700'000'000'999'999'999};
  for (const std::int64_t time : times) ASSERT_TRUE(out->write(payloadOf(0), time));
  ASSERT_TRUE(waitFor(inbox, times.size()));
  const std::vector<Received> received = inbox.samples();
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(received[i].source_timestamp_ns, times[i]);
}

TEST_F(EndpointTest, SamplesLargerThanForeseenStillPass) {
  Participant a(memberOptions("a", "cell")), b(memberOptions("b", "cell"));
  Inbox inbox(signal_);
  EndpointOptions options = rawOptions(Profile::kLoop);
  options.max_payload = 64;
  auto in = reader(b, options, inbox);
  auto out = writer(a, options);
  ASSERT_TRUE(match(*out, *in));
  const std::vector<std::size_t> sizes{64, 68, 5'000, 60'000, 200'000};  // the last in fragments
  for (const std::size_t size : sizes) ASSERT_TRUE(out->write(payloadOf(7, size))) << size;
  ASSERT_TRUE(waitFor(inbox, sizes.size()));
  const std::vector<Received> received = inbox.samples();
  for (std::size_t i = 0; i < sizes.size(); ++i) EXPECT_EQ(received[i].payload, payloadOf(7, sizes[i]));
}

TEST_F(EndpointTest, ATopicHasOneTypeInAProcess) {
  Participant participant(memberOptions("a", "cell"));
  auto out = writer(participant, rawOptions(Profile::kLoop));
  EndpointOptions options = rawOptions(Profile::kLoop);
  options.type = "baton::test::Other";
  EXPECT_THROW(RawWriter(participant, options), UsageError);
}

}  // namespace
}  // namespace baton::dds
