/// Who else is in the domain, and what they write.
#include "dds/participant.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "dds/endpoint.hpp"
#include "dds/process.hpp"
#include "loopback.hpp"
#include "support/impostor.hpp"

namespace baton::dds {
namespace {

using test::Inbox;
using test::memberOptions;
using test::Signal;

/// Writers in one partition, as watchWriters() tells of them. Outlives the participant it listens to.
class Watch {
 public:
  Watch(Signal& signal, const std::string& partition) : signal_(signal), partition_(test::testPartition(partition)) {}

  void listenTo(Participant& participant) {
    participant.watchWriters([this](const DiscoveredWriter& writer) {
      {
        const std::lock_guard lock(mutex_);
        const auto& names = writer.partitions;
        if (std::find(names.begin(), names.end(), partition_) != names.end()) found_[writer.guid] = writer;
      }
      signal_.notify();
    });
  }
  [[nodiscard]] std::map<Guid, DiscoveredWriter> found() const {
    const std::lock_guard lock(mutex_);
    return found_;
  }

 private:
  Signal& signal_;
  std::string partition_;
  mutable std::mutex mutex_;
  std::map<Guid, DiscoveredWriter> found_;
};

TEST(ParticipantTest, AWatchThatIsTakenAwayIsNotCalledAnyMore) {
  std::promise<void> entered, let_go;  // these outlive the participant that calls back
  std::atomic<int> calls{0}, returns{0};
  Participant watcher(memberOptions("watcher", "cell"));
  watcher.watchWriters([&](const DiscoveredWriter&) {
    if (++calls == 1) {
      entered.set_value();
      let_go.get_future().wait();
    }
    ++returns;
  });
  Participant other(memberOptions("other", "cell"));
  const RawWriter first(other, {.topic = "first", .type = "Bytes"});
  ASSERT_EQ(entered.get_future().wait_for(std::chrono::minutes(1)), std::future_status::ready);
  auto taken_away = std::async(std::launch::async, [&] {
    watcher.watchWriters({});
    return std::pair{calls.load(), returns.load()};
  });
  let_go.set_value();
  const auto [called, returned] = taken_away.get();
  EXPECT_EQ(called, returned) << "a call was still under way";

  Signal signal;
  Watch later(signal, "cell");
  const RawWriter second(other, {.topic = "second", .type = "Bytes"});
  later.listenTo(watcher);
  ASSERT_TRUE(signal.waitUntil([&] { return later.found().count(second.guid()) == 1; }));
  EXPECT_EQ(calls, called);
}

TEST(ParticipantTest, DomainsOutsideTheRangeAreRefused) {
  for (const int domain : {-1, 233, 1'000'000}) {
    ParticipantOptions options = memberOptions("a", "cell");
    options.domain = domain;
    EXPECT_THROW(Participant{options}, UsageError) << domain;
  }
}

TEST(ParticipantTest, PeersSayWhoTheyAreAndLeave) {
  Signal signal;
  Participant watcher(memberOptions("watcher", "cell"), [&](const Peer&) { signal.notify(); });
  const auto find = [&](const std::string& service) -> std::optional<Peer> {
    for (const Peer& peer : watcher.peers()) {
      if (peer.run == std::to_string(getpid()) && peer.service == service) return peer;
    }
    return std::nullopt;
  };
  {
    Participant plant(memberOptions("plant", "elsewhere"));  // peers are seen across partitions
    ASSERT_TRUE(signal.waitUntil([&] { return find("plant").has_value(); }));
    EXPECT_EQ(find("plant")->cell, "unit");
    EXPECT_FALSE(find("watcher")) << "oneself is no peer";
  }
  // A farewell has no callback of its own. It comes on the thread that also tells of the next arrival, before or after
  // it.
  for (int i = 0; i < 100 && find("plant"); ++i) {
    const std::string name = "later" + std::to_string(i);
    Participant later(memberOptions(name, "cell"));
    ASSERT_TRUE(signal.waitUntil([&] { return find(name).has_value(); }));
  }
  EXPECT_FALSE(find("plant"));
}

/// Names are shown in logs and on terminals.
TEST(ParticipantTest, AProcessWhoseNameWouldChangeATerminalIsNoneOfOurs) {
  Signal signal;
  Watch watch(signal, "cell");
  Participant watcher(memberOptions("watcher", "cell"), [&](const Peer&) { signal.notify(); });
  watch.listenTo(watcher);
  Participant wrong(memberOptions("a\x1b[2J", "cell")), broken(memberOptions("\xff", "cell"));
  Participant right(memberOptions("right", "cell"));
  const RawWriter first(wrong, {.topic = "first", .type = "Bytes"}),
      second(broken, {.topic = "second", .type = "Bytes"});
  const auto isRight = [](const Peer& peer) { return peer.service == "right"; };
  ASSERT_TRUE(signal.waitUntil([&] { return std::ranges::any_of(watcher.peers(), isRight); }));
  // A participant is met before its writers are.
  ASSERT_TRUE(signal.waitUntil([&] { return watch.found().size() == 2; }));
  for (const Peer& peer : watcher.peers()) EXPECT_TRUE(isRight(peer)) << peer.service;
}

TEST(ParticipantTest, AMemberHasTheKeyWhicheverRunItNames) {
  Signal signal;
  const RunKey key = RunKey::fresh();
  const auto options = [&](const std::string& service, bool has_key, const std::string& run) {
    ParticipantOptions result = memberOptions(service, "cell");
    if (has_key) result.key = key;
    result.role = Role::kController;
    if (!run.empty()) result.run = run;
    return result;
  };
  Participant plant(options("plant", true, ""), [&](const Peer&) { signal.notify(); });
  const Participant one(options("one", true, "")), other(options("other", false, "another-run"));
  const auto prefix = [](const Participant& participant) { return participant.self().prefix; };
  ASSERT_TRUE(signal.waitUntil([&] { return plant.peer(prefix(one)) && plant.peer(prefix(other)); }));
  EXPECT_TRUE(plant.member(prefix(one)));
  EXPECT_FALSE(plant.member(prefix(other))) << "it is no stranger, since it claims nothing of ours";
  EXPECT_FALSE(plant.stranger(prefix(other)));
}

/// Members of one run, and what anybody can make of what they say.
class ARunsMembers : public ::testing::Test {
 protected:
  [[nodiscard]] ParticipantOptions options(const std::string& service, Role role) const {
    ParticipantOptions result = memberOptions(service, "cell");
    result.key = key_;
    result.role = role;
    return result;
  }
  /// As the plant sees them once it has met them.
  [[nodiscard]] bool isMet(const Participant& member) {
    return signal_.waitUntil([&] { return plant_.peer(member.self().prefix).has_value(); });
  }
  [[nodiscard]] bool isMetAsAStranger(const test::Words& words) {
    return signal_.waitUntil([&] { return plant_.stranger(words.prefix).has_value(); });
  }
  [[nodiscard]] test::Words wordsOf(const Participant& member) {
    std::optional<test::Words> words;
    const auto isOfMember = [&](const test::Words& one) { return one.prefix == member.self().prefix; };
    EXPECT_TRUE(signal_.waitUntil([&] { return (words = spy_.wordsOf(isOfMember)).has_value(); }));
    return words.value_or(test::Words{});
  }

  RunKey key_ = RunKey::fresh();
  Signal signal_;
  test::Impostor spy_{test::ownDomain(), [this] { signal_.notify(); }};
  Participant plant_{options("plant", Role::kPlant), [this](const Peer&) { signal_.notify(); }};
};

TEST_F(ARunsMembers, HaveTheirRoleInTheirPrefix) {
  const Participant controller(options("pd", Role::kController)), command(options("operator-1", Role::kOperator));
  ASSERT_TRUE(isMet(controller) && isMet(command));
  EXPECT_EQ(plant_.roleOf(controller.self().prefix), Role::kController);
  EXPECT_EQ(plant_.roleOf(command.self().prefix), Role::kOperator);
}

TEST_F(ARunsMembers, HaveNoHeirsOnceTheyHaveLeft) {
  auto controller = std::make_unique<Participant>(options("pd", Role::kController));
  ASSERT_TRUE(isMet(*controller));
  const test::Words words = wordsOf(*controller);
  controller.reset();
  Inbox inbox(signal_);
  const EndpointOptions endpoint{.topic = "heard", .type = "baton::msg::Event", .profile = Profile::kEvent};
  RawReader reader(plant_, endpoint, [&](const RawSample& sample) { inbox.put(sample); });
  test::Impostor heir(test::ownDomain(), words, test::testPartition("cell"));
  // It is there, and speaks: the reader has what it says, and the plant knows better than to take it for the member.
  const Topic<msg::Event> heard{{endpoint.topic.c_str(), endpoint.type.c_str(), endpoint.profile, {}, {}}};
  std::ignore = heir.say(heard, msg::Event{});
  ASSERT_TRUE(signal_.waitUntil([&] { return inbox.size() > 0; }));
  EXPECT_EQ(prefixOf(inbox.samples().front().writer), words.prefix);
  EXPECT_EQ(plant_.departures(), 1U);
  EXPECT_FALSE(plant_.roleOf(words.prefix));
  EXPECT_FALSE(plant_.isMember(words.prefix));
  EXPECT_FALSE(plant_.peer(words.prefix));
  ASSERT_TRUE(plant_.departed(words.prefix));
  EXPECT_EQ(plant_.departed(words.prefix)->service, "pd");
}

TEST_F(ARunsMembers, HaveNoneEitherWhenTheyAreDead) {
  const Participant controller(options("pd", Role::kController));
  ASSERT_TRUE(isMet(controller));
  const GuidPrefix prefix = controller.self().prefix;
  plant_.bury(prefix);
  EXPECT_EQ(plant_.departures(), 1U);
  EXPECT_FALSE(plant_.isMember(prefix));
  EXPECT_FALSE(plant_.peer(prefix));
  plant_.bury(prefix);
  EXPECT_EQ(plant_.departures(), 1U);
}

/// What a dead one said of itself can be said again, with its proof, to whoever has not met it.
TEST_F(ARunsMembers, AreNotThoseWhoWereDeadBeforeTheyCame) {
  const pid_t child = fork();
  while (child == 0) pause();
  const std::string words = "baton\nunit\n" + std::to_string(getpid()) + "\npd\n5\n" + std::to_string(child) + "\n" +
                            std::to_string(processBegan(child)) + "\n";
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  const GuidPrefix prefix = key_.marked(plant_.self().prefix, Role::kController);
  Inbox inbox(signal_);
  const EndpointOptions endpoint{.topic = "heard", .type = "baton::msg::Event", .profile = Profile::kEvent};
  RawReader reader(plant_, endpoint, [&](const RawSample& sample) { inbox.put(sample); });
  test::Impostor heir(test::ownDomain(), {prefix, words + key_.proofOf(prefix, words)}, test::testPartition("cell"));
  const Topic<msg::Event> heard{{endpoint.topic.c_str(), endpoint.type.c_str(), endpoint.profile, {}, {}}};
  std::ignore = heir.say(heard, msg::Event{});
  ASSERT_TRUE(signal_.waitUntil([&] { return inbox.size() > 0; }));
  ASSERT_TRUE(plant_.departed(prefix));
  EXPECT_EQ(plant_.departed(prefix)->service, "pd");
  EXPECT_FALSE(plant_.isMember(prefix));
  EXPECT_FALSE(plant_.peer(prefix));
  EXPECT_EQ(plant_.departures(), 1U);
}

/// A prefix that was seen can be had. What is said under it needs the key.
TEST_F(ARunsMembers, AreNotTheOnesThatBearTheMarkAlone) {
  const std::string place = "baton\nunit\n" + std::to_string(getpid()) + "\n";
  for (const std::string& user_data :
       {std::string(), std::string("something else"), place + "environment\n5\n" + std::to_string(getpid()) + "\n1\n",
        place + "pd\n5\n1\n1\n" + key_.proofOf({}, place + "pd\n5\n1\n1\n"),
        std::string("baton\nunit\nanother-run\nplant\n5\n1\n1\n")}) {
    const test::Words words{key_.marked(plant_.self().prefix, Role::kEnvironment), user_data};
    const test::Impostor impostor(test::ownDomain(), words, test::testPartition("cell"));
    ASSERT_TRUE(isMetAsAStranger(words)) << user_data;
    EXPECT_FALSE(plant_.isMember(words.prefix)) << user_data;
    EXPECT_FALSE(plant_.peer(words.prefix)) << user_data;
  }
}

/// Words are proven together with the prefix.
TEST_F(ARunsMembers, CannotLendTheirWords) {
  const Participant controller(options("pd", Role::kController));
  ASSERT_TRUE(isMet(controller));
  test::Words words = wordsOf(controller);
  words.prefix = key_.marked(words.prefix, Role::kController);
  const test::Impostor impostor(test::ownDomain(), words, test::testPartition("cell"));
  ASSERT_TRUE(isMetAsAStranger(words));
  EXPECT_FALSE(plant_.isMember(words.prefix));
  EXPECT_TRUE(plant_.isMember(controller.self().prefix));
}

TEST(ParticipantTest, CellsDiscoverTheirOwnMembersAndWhoObservesAnyOfThem) {
  Signal signal;
  const auto member = [&](const std::string& cell) {
    ParticipantOptions options = memberOptions(cell, "cell");
    options.cell = cell;
    return std::make_unique<Participant>(options, [&](const Peer&) { signal.notify(); });
  };
  const auto knows = [](const Participant& one, const std::string& service) {
    const std::vector<Peer> peers = one.peers();
    return std::any_of(peers.begin(), peers.end(), [&](const Peer& peer) { return peer.service == service; });
  };
  const auto left = member("left"), right = member("right"), anybody = member("");
  EXPECT_TRUE(signal.waitUntil([&] { return knows(*anybody, "left") && knows(*anybody, "right"); }));
  EXPECT_TRUE(signal.waitUntil([&] { return knows(*left, "") && knows(*right, ""); }));
  EXPECT_FALSE(knows(*left, "right"));
  EXPECT_FALSE(knows(*right, "left"));
}

TEST(ParticipantTest, WhoIsHeardElsewhereFindsMembersOfOtherCells) {
  Signal signal;
  ParticipantOptions options = memberOptions("replayer", "replay");
  options.cell = "replay";
  options.other_partitions = {test::testPartition("cell")};
  Participant replayer(options), member(memberOptions("controller", "cell"));
  const EndpointOptions endpoint{.topic = "heard", .type = "baton::test::A"};
  Inbox inbox(signal);
  RawWriter writer(replayer, endpoint, [&] { signal.notify(); });
  RawReader reader(
      member, endpoint, [&](const RawSample& sample) { inbox.put(sample); }, [&] { signal.notify(); });
  EXPECT_TRUE(signal.waitUntil([&] { return !writer.matched().empty() && !reader.matched().empty(); }));
}

TEST(DiscoveryGroup, IsACellsOwn) {
  const auto partsOf = [](const std::string& group) {
    int parts[4] = {};
    EXPECT_EQ(std::sscanf(group.c_str(), "%d.%d.%d.%d", &parts[0], &parts[1], &parts[2], &parts[3]), 4) << group;
    return std::to_array(parts);
  };
  std::set<std::string> groups;
  for (int cell = 0; cell < 100; ++cell) {
    const std::string group = discoveryGroup("cell" + std::to_string(cell));
    EXPECT_EQ(group, discoveryGroup("cell" + std::to_string(cell)));
    const std::array<int, 4> parts = partsOf(group);
    EXPECT_EQ(parts[0], 239);
    EXPECT_EQ(parts[1], 255);
    EXPECT_TRUE(parts[2] >= 1 && parts[2] <= 254) << group << ": 239.255.0.1 is that of RTPS";
    EXPECT_TRUE(parts[3] >= 1 && parts[3] <= 254) << group;
    groups.insert(group);
  }
  EXPECT_EQ(groups.size(), 100U);
  EXPECT_EQ(discoveryGroup("lab"), "239.255.46.119") << "processes of two builds find each other";
}

TEST(ParticipantTest, WatchWritersFindsThoseThereAreAndThoseToCome) {
  Signal signal;
  Watch watch(signal, "cell");
  Participant plant(memberOptions("plant", "cell")), recorder(memberOptions("recorder", "cell"));
  RawWriter early(plant, {.topic = "early", .type = "baton::test::A", .profile = Profile::kStatus});
  {
    // Once a reader of the recorder is matched with it, discovery knows the writer.
    RawReader probe(
        recorder, {.topic = "early", .type = "baton::test::A", .profile = Profile::kStatus}, [](const RawSample&) {},
        [&] { signal.notify(); });
    ASSERT_TRUE(signal.waitUntil([&] { return probe.matched().size() == 1; }));
  }
  watch.listenTo(recorder);
  ASSERT_TRUE(signal.waitUntil([&] { return watch.found().contains(early.guid()); }));
  const DiscoveredWriter status = watch.found().at(early.guid());
  EXPECT_EQ(status.topic, "early");
  EXPECT_EQ(status.type, "baton::test::A");
  EXPECT_TRUE(status.reliable);
  EXPECT_TRUE(status.transient_local);
  EXPECT_FALSE(status.keyed);
  EXPECT_FALSE(status.exclusive_ownership);
  EXPECT_EQ(status.partitions, std::vector<std::string>{test::testPartition("cell")});
  EXPECT_NE(status.qos_text.find("durability: transient_local"), std::string::npos);

  RawWriter later(plant, {.topic = "later", .type = "baton::test::B", .profile = Profile::kLoop, .keyed = true});
  ASSERT_TRUE(signal.waitUntil([&] { return watch.found().contains(later.guid()); }));
  const DiscoveredWriter loop = watch.found().at(later.guid());
  EXPECT_EQ(loop.topic, "later");
  EXPECT_EQ(loop.type, "baton::test::B");
  EXPECT_FALSE(loop.transient_local);
  EXPECT_TRUE(loop.keyed);
  EXPECT_EQ(watch.found().size(), 2u);
}

TEST(ParticipantTest, TheTextOfAWritersQosSaysWhatItPromises) {
  Signal signal;
  Watch watch(signal, "cell");
  Participant plant(memberOptions("plant", "cell")), recorder(memberOptions("recorder", "cell"));
  watch.listenTo(recorder);
  RawWriter modest(plant, {.topic = "modest", .type = "baton::test::A"});
  RawWriter bold(plant, {.topic = "bold",
                         .type = "baton::test::A",
                         .exclusive_ownership = true,
                         .best_effort = true,
                         .deadline_ns = 20'000'000,
                         .liveliness = {.kind = Liveliness::Kind::kManualByTopic, .lease_ns = 3'000'000'000},
                         .ownership_strength = 7});
  ASSERT_TRUE(
      signal.waitUntil([&] { return watch.found().contains(modest.guid()) && watch.found().contains(bold.guid()); }));
  const std::string partition = "partition: " + test::testPartition("cell") + "\n";
  EXPECT_EQ(watch.found().at(modest.guid()).qos_text,
            "reliability: reliable\ndurability: volatile\nownership: shared\nkeyed: false\n" + partition);
  EXPECT_EQ(watch.found().at(bold.guid()).qos_text,
            "reliability: best_effort\ndurability: volatile\nownership: exclusive\nkeyed: false\n"
            "deadline_ns: 20000000\nliveliness: manual_by_topic\nlease_ns: 3000000000\nownership_strength: 7\n" +
                partition);
}

TEST(ParticipantTest, WhatIsLongerThanDdsCanSayIsForEver) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000, kLongest_s = std::numeric_limits<std::int32_t>::max() - 1;
  Signal signal;
  Watch watch(signal, "cell");
  Participant recorder(memberOptions("recorder", "cell")), plant(memberOptions("plant", "cell"));
  watch.listenTo(recorder);
  const auto qosOf = [&](std::int64_t duration_ns) {
    const RawWriter writer(plant, {.topic = "topic",
                                   .type = "baton::test::A",
                                   .deadline_ns = duration_ns,
                                   .liveliness = {.lease_ns = duration_ns}});
    EXPECT_TRUE(signal.waitUntil([&] { return watch.found().contains(writer.guid()); }));
    return watch.found().at(writer.guid()).qos_text;
  };
  const std::string longest_ns = std::to_string(kLongest_s * kSecond_ns);
  EXPECT_NE(qosOf(kLongest_s * kSecond_ns).find("deadline_ns: " + longest_ns + "\nlease_ns: " + longest_ns + "\n"),
            std::string::npos);
  for (const std::int64_t duration_ns : {(kLongest_s + 1) * kSecond_ns, std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(qosOf(duration_ns).find("_ns"), std::string::npos);
  }
}

TEST(ParticipantTest, WritersAreHeardInOtherPartitionsAsWell) {
  Signal signal;
  ParticipantOptions options = memberOptions("plant", "cell");
  options.other_partitions = {test::testPartition("second"), ""};
  Participant plant(options);
  RawWriter out(plant, {.topic = "topic", .type = "baton::test::A", .profile = Profile::kEvent});
  std::vector<std::unique_ptr<Participant>> members;
  std::vector<std::unique_ptr<RawReader>> readers;
  for (const char* partition : {"cell", "second", "third"}) {
    members.push_back(std::make_unique<Participant>(memberOptions(partition, partition)));
  }
  ParticipantOptions nowhere = memberOptions("nowhere", "");
  nowhere.partition.clear();
  members.push_back(std::make_unique<Participant>(nowhere));
  readers.reserve(members.size());
  for (const auto& member : members) {
    readers.push_back(std::make_unique<RawReader>(
        *member, EndpointOptions{.topic = "topic", .type = "baton::test::A", .profile = Profile::kEvent},
        [](const RawSample&) {}, [&] { signal.notify(); }));
  }
  EXPECT_TRUE(signal.waitUntil([&] {
    return !readers[0]->matched().empty() && !readers[1]->matched().empty() && !readers[3]->matched().empty();
  }));
  EXPECT_TRUE(readers[2]->matched().empty());
}

TEST(ParticipantTest, AParticipantMadeLaterLearnsOfTheWritersThereAre) {
  Signal signal;
  Watch watch(signal, "cell");
  Participant plant(memberOptions("plant", "cell"));
  RawWriter out(plant, {.topic = "topic", .type = "baton::test::A", .profile = Profile::kLoop});
  Participant recorder(memberOptions("recorder", "observers"));  // another partition: it sees, and does not match
  watch.listenTo(recorder);
  EXPECT_TRUE(signal.waitUntil([&] { return watch.found().contains(out.guid()); }));
}

}  // namespace
}  // namespace baton::dds
