#include "dds/gate.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dds/endpoint.hpp"
#include "loopback.hpp"

namespace baton::dds {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr GuidPrefix kStranger{1, 15, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, std::initializer_list<int> more) {
  for (const int one : more) bytes.push_back(static_cast<std::byte>(one));
}

Bytes messageOf(const GuidPrefix& sender) {
  Bytes bytes;
  append(bytes, {'R', 'T', 'P', 'S', 2, 3, 1, 15});
  for (const std::uint8_t one : sender) bytes.push_back(static_cast<std::byte>(one));
  return bytes;
}

/// A submessage of little endian, whose body is filled up with zeros.
void add(Bytes& message, int kind, std::initializer_list<int> body, int size) {
  append(message, {kind, 1, size & 0xff, size >> 8});
  append(message, body);
  message.resize(message.size() + static_cast<std::size_t>(size) - body.size());
}

/// A message that asks for 32 samples a word of the map.
Bytes askingFor(const GuidPrefix& sender, int words) {
  Bytes message = messageOf(sender);
  append(message, {0x06, 1, 24 + 4 * words, 0});
  message.resize(message.size() + 16);
  append(message, {(32 * words) & 0xff, (32 * words) >> 8, 0, 0});
  message.resize(message.size() + 4 * static_cast<std::size_t>(words), std::byte{0xff});
  message.resize(message.size() + 4);
  return message;
}

class GateTest : public ::testing::Test {
 protected:
  [[nodiscard]] Gate gate(Strangers strangers) {
    return {key_, strangers, [this](const GuidPrefix& prefix, Trespass what) { told_.emplace_back(prefix, what); }};
  }
  [[nodiscard]] Bytes speaking(const GuidPrefix& sender) const {
    Bytes message = messageOf(sender);
    add(message, 0x0e, {}, 12);  // INFO_DST
    add(message, 0x09, {}, 8);   // INFO_TS
    add(message, 0x15, {}, 40);  // DATA
    return message;
  }

  const RunKey key_ = RunKey::fresh();
  const GuidPrefix member_ = key_.marked(kStranger, Role::kController);
  std::vector<std::pair<GuidPrefix, Trespass>> told_;
};

TEST_F(GateTest, MembersSpeak) {
  Gate gate = this->gate(Strangers::kAsk);
  for (std::size_t i = 0; i < kRoles; ++i) {
    EXPECT_TRUE(gate.admits(speaking(key_.marked(kStranger, static_cast<Role>(i))), 0));
  }
  EXPECT_TRUE(gate.admits(speaking(member_), 0)) << "as before";
  EXPECT_EQ(gate.turnedAway(), 0U);
}

TEST_F(GateTest, StrangersDoNot) {
  for (const Strangers strangers : {Strangers::kAsk, Strangers::kAskFreely}) {
    Gate gate = this->gate(strangers);
    told_.clear();
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(gate.admits(speaking(kStranger), 0));
    EXPECT_EQ(gate.turnedAway(), 3U);
    ASSERT_EQ(told_.size(), 1U) << "once";
    EXPECT_EQ(told_[0], std::pair(kStranger, Trespass::kSpeaks));
  }
  EXPECT_TRUE(gate(Strangers::kSpeakFreely).admits(speaking(kStranger), 0));
}

/// Whatever is not known to ask: data, fragments of it, gaps and heartbeats, which say that there is data, another
/// sender, security, what vendors add.
TEST_F(GateTest, NothingOfThemButQuestionsComesIn) {
  for (int kind = 0; kind < 256; ++kind) {
    Gate gate = this->gate(Strangers::kAsk);
    Bytes message = messageOf(kStranger);
    add(message, kind, {}, 28);
    // From 0x80 on they are what vendors add, and nobody else looks at.
    const bool asks = kind == 0x01 || kind == 0x06 || kind == 0x09 || kind == 0x0e || kind == 0x12 || kind >= 0x80;
    EXPECT_EQ(gate.admits(message, 0), asks) << kind;
  }
}

TEST_F(GateTest, DataBehindAQuestionDoesNotEither) {
  Gate gate = this->gate(Strangers::kAsk);
  Bytes message = askingFor(kStranger, 1);
  ASSERT_TRUE(gate.admits(message, 0));
  add(message, 0x15, {}, 40);
  EXPECT_FALSE(gate.admits(message, 0));
  Bytes last = messageOf(kStranger);
  add(last, 0x0e, {}, 0);  // of no length: goes on to the end
  append(last, {0x15, 1, 0, 0});
  EXPECT_TRUE(gate.admits(last, 0)) << "which DDS takes for its body as well";
  Bytes hidden = messageOf(kStranger);  // DDS goes on at a multiple of four, where data are
  append(hidden, {1, 1, 1, 0, 0, 1, 1, 0});
  add(hidden, 0x15, {}, 40);
  EXPECT_FALSE(gate.admits(hidden, 0));
  Bytes too_long = messageOf(kStranger);
  append(too_long, {1, 1, 0, 0x15});
  add(too_long, 0x15, {}, 40);
  EXPECT_FALSE(gate.admits(too_long, 0));
  Bytes short_map = messageOf(kStranger);  // DDS reads the map behind the end as well
  append(short_map, {6, 1, 20, 0});
  short_map.resize(short_map.size() + 16);
  append(short_map, {0, 1, 0, 0});
  short_map.resize(short_map.size() + 32, std::byte{0xff});
  EXPECT_FALSE(gate.admits(short_map, 0));
  Bytes timed = messageOf(kStranger);
  add(timed, 0x09, {}, 0);  // which has a length of its own
  add(timed, 0x15, {}, 40);
  EXPECT_FALSE(gate.admits(timed, 0));
}

/// As Fast DDS sends it, with statistics behind.
TEST_F(GateTest, AnAcknowledgementOfFastDdsComesIn) {
  Gate gate = this->gate(Strangers::kAsk);
  Bytes message = messageOf(kStranger);
  add(message, 0x0e, {}, 12);
  add(message, 0x06, {}, 24);
  add(message, 0x80, {}, 56);
  EXPECT_TRUE(gate.admits(message, 0));
}

TEST_F(GateTest, WhatIsNoMessageIsNobodys) {
  Gate gate = this->gate(Strangers::kAsk);
  const Bytes whole = speaking(member_);
  for (std::size_t size = 0; size < 20; ++size) {
    EXPECT_FALSE(gate.admits(std::span(whole).first(size), 0)) << size;
  }
  EXPECT_EQ(told_.size(), 0U);
  for (const Bytes& asks : {askingFor(kStranger, 8), speaking(kStranger)}) {
    for (std::size_t size = 20; size <= asks.size(); ++size) {
      (void)gate.admits(std::span(asks).first(size), 0);  // reads no byte behind
    }
  }
}

TEST_F(GateTest, AllStrangersTogetherAskForSoMuchASecond) {
  Gate gate = this->gate(Strangers::kAsk);
  const int each = 1 + 8 * 32;
  const auto ask = [&](std::int64_t now_ns) {
    int admitted = 0;
    GuidPrefix stranger = kStranger;
    for (int i = 0; i < 100; ++i) {
      stranger[11] = static_cast<std::uint8_t>(i);
      if (gate.admits(askingFor(stranger, 8), now_ns)) ++admitted;
    }
    return admitted;
  };
  EXPECT_EQ(ask(0), Gate::kAsksPerSecond / each);
  EXPECT_EQ(ask(1000), 0);
  EXPECT_EQ(ask(kSecond_ns / 2), (Gate::kAsksPerSecond % each + Gate::kAsksPerSecond / 2) / each);
  EXPECT_EQ(ask(100 * kSecond_ns), Gate::kAsksPerSecond / each) << "what was not asked for is not saved up";
  EXPECT_EQ(told_[0].second, Trespass::kAsksTooMuch);
  EXPECT_EQ(told_.size(), 100U) << "each once";
  Gate open = this->gate(Strangers::kAskFreely);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(open.admits(askingFor(kStranger, 8), 0));
}

TEST_F(GateTest, SoManyAreTold) {
  Gate gate = this->gate(Strangers::kAsk);
  GuidPrefix stranger = kStranger;
  for (std::size_t i = 0; i < Gate::kMostTold + 10; ++i) {
    stranger[10] = static_cast<std::uint8_t>(i >> 8);
    stranger[11] = static_cast<std::uint8_t>(i);
    EXPECT_FALSE(gate.admits(speaking(stranger), 0));
  }
  EXPECT_EQ(told_.size(), Gate::kMostTold);
  EXPECT_EQ(gate.turnedAway(), Gate::kMostTold + 10);
}

constexpr int kTheirs = 40;
const EndpointOptions kShared{.topic = "shared", .type = "test::Shared", .profile = Profile::kRequest};

/// A process of its own that writes into the future, loses half of it on the way, and stops: nobody makes good what was
/// lost. Ends with the object.
class StoppedStranger {
 public:
  StoppedStranger() : place_(test::memberOptions("stranger", "gate")) {
    if (pipe(go_.data()) != 0) throw std::runtime_error("no pipe");
    pid_ = fork();
    if (pid_ != 0) return;
    setenv("BATON_LOSE_ONE_IN", "2", 1);
    test::Signal signal;
    std::atomic<int> matched{0};
    Participant stranger(place_);
    std::vector<std::unique_ptr<RawWriter>> writers;
    for (int i = 0; i < kTheirs; ++i) {
      writers.push_back(std::make_unique<RawWriter>(stranger, kShared, [&] {
        ++matched;
        signal.notify();
      }));
    }
    char byte = 0;
    if (read(go_[0], &byte, 1) != 1 || !signal.waitUntil([&] { return matched == kTheirs; })) _exit(1);
    const std::vector<std::byte> payload(8, std::byte{1});
    constexpr std::int64_t kIn2060_ns = 2'840'000'000'000'000'000;
    for (const auto& one : writers) {
      for (int i = 0; i < 30; ++i) (void)one->write(payload, kIn2060_ns);
    }
    raise(SIGSTOP);
    _exit(1);
  }
  ~StoppedStranger() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    for (const int end : go_) close(end);
  }
  StoppedStranger(const StoppedStranger&) = delete;
  StoppedStranger& operator=(const StoppedStranger&) = delete;

  /// Lets it write, and waits until it has.
  [[nodiscard]] bool attacks() const {
    int status = 0;
    return write(go_[1], "", 1) == 1 && waitpid(pid_, &status, WUNTRACED) == pid_ && WIFSTOPPED(status);
  }

 private:
  ParticipantOptions place_;
  std::array<int, 2> go_{};
  pid_t pid_ = 0;
};

/// DDS keeps what it cannot deliver yet: samples behind one that was lost. All writers share the room for it, and those
/// with the oldest time stamps have to leave, which would be those of the run.
TEST(Gate, SamplesOfStrangersTakeNoRoomFromThoseOfMembers) {
  const StoppedStranger stranger;  // before this process has threads
  test::Signal signal;
  test::Inbox inbox(signal);
  ParticipantOptions ours = test::memberOptions("reader", "gate");
  ours.key = RunKey::fresh();
  std::atomic<int> told{0}, matched{0};
  Participant reading(ours, {}, [&](const GuidPrefix&, Trespass) { ++told; });
  ours.service = "writer";
  Participant writing(ours);
  RawWriter writer(writing, kShared);
  RawReader reader(
      reading, kShared, [&](const RawSample& sample) { inbox.put(sample); },
      [&] {
        ++matched;
        signal.notify();
      });
  ASSERT_TRUE(signal.waitUntil([&] { return matched == kTheirs + 1 && !writer.matched().empty(); }));
  ASSERT_TRUE(stranger.attacks());
  const Bytes payload(8, std::byte{1});
  for (std::size_t i = 1; i <= 30; ++i) {
    ASSERT_TRUE(writer.write(payload));
    ASSERT_TRUE(signal.waitUntil([&] { return inbox.size() == i; })) << i;
  }
  EXPECT_EQ(told, 1);
  EXPECT_GT(reading.turnedAway(), 0U);
}

}  // namespace
}  // namespace baton::dds
