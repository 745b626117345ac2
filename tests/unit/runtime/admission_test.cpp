#include "runtime/admission.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "runtime/service_options.hpp"
#include "support/impostor.hpp"
#include "support/own_domain.hpp"

namespace baton {
namespace {

using enum dds::WrittenBy;
using dds::Role;

constexpr std::array kEveryTopic{kPlant,    kEnvironment, kTrajectory, kControllers, kRecorder,
                                 kReplayer, kSupervisor,  kServices,   kOperators};

TEST(Admission, LetsAServiceSpeakOnItsOwnTopics) {
  EXPECT_TRUE(mayWrite(kPlant, Role::kPlant));
  EXPECT_TRUE(mayWrite(kEnvironment, Role::kEnvironment));
  EXPECT_TRUE(mayWrite(kTrajectory, Role::kTrajectory));
  EXPECT_TRUE(mayWrite(kControllers, Role::kController));
  EXPECT_TRUE(mayWrite(kRecorder, Role::kRecorder));
  EXPECT_TRUE(mayWrite(kReplayer, Role::kReplayer));
  for (std::size_t i = 0; i < dds::kRoles; ++i) {
    const Role role = static_cast<Role>(i);
    EXPECT_EQ(mayWrite(kServices, role), role != Role::kOperator);
    EXPECT_TRUE(mayWrite(kOperators, role));
  }
}

TEST(Admission, AndOnNoOther) {
  for (const dds::WrittenBy topic : kEveryTopic) {
    if (topic == kServices || topic == kOperators) continue;
    int writers = 0;
    for (std::size_t i = 0; i < dds::kRoles; ++i) {
      const Role role = static_cast<Role>(i);
      if (role != Role::kSupervisor && mayWrite(topic, role)) ++writers;
    }
    EXPECT_EQ(writers, topic == kSupervisor ? 0 : 1) << static_cast<int>(topic);
    EXPECT_FALSE(mayWrite(topic, Role::kOperator));
  }
}

TEST(Admission, TheSupervisorSpeaksForWhoHasDied) {
  for (const dds::WrittenBy topic : kEveryTopic) EXPECT_TRUE(mayWrite(topic, Role::kSupervisor));
}

TEST(Admission, ANameSaysTheRole) {
  EXPECT_EQ(roleCalled(kPlantName), Role::kPlant);
  EXPECT_EQ(roleCalled(kEnvironmentName), Role::kEnvironment);
  EXPECT_EQ(roleCalled(kTrajectoryName), Role::kTrajectory);
  EXPECT_EQ(roleCalled(kRecorderName), Role::kRecorder);
  EXPECT_EQ(roleCalled(kReplayerName), Role::kReplayer);
  EXPECT_EQ(roleCalled(kSupervisorName), Role::kSupervisor);
  EXPECT_EQ(roleCalled(std::string(kOperatorPrefix) + "123"), Role::kOperator);
  EXPECT_EQ(roleCalled("impedance"), Role::kController);
}

/// A command that was killed says no farewell, and DDS takes it for alive.
TEST(Admission, HearsACommandAsLongAsItsProcessRuns) {
  const dds::RunKey key = dds::RunKey::fresh();
  std::mutex mutex;
  std::condition_variable met;
  const dds::Participant plant({.domain = test::ownDomain(),
                                .partition = "lab/run",
                                .cell = "lab",
                                .run = "run",
                                .service = kPlantName,
                                .role = Role::kPlant,
                                .key = key},
                               [&](const dds::Peer&) {
                                 const std::lock_guard lock(mutex);
                                 met.notify_all();
                               });
  Admission admission(plant, false, [](const std::string&) {});
  const auto isHeard = [&](int pid) {
    const dds::GuidPrefix prefix = key.marked(plant.self().prefix, Role::kOperator);
    const std::string fields = "baton\nlab\nrun\noperator-1\n5\n" + std::to_string(pid) + "\n0\n";
    const test::Impostor command(test::ownDomain(), {prefix, fields + key.proofOf(prefix, fields)}, "lab/run");
    std::unique_lock lock(mutex);
    EXPECT_TRUE(met.wait_for(lock, std::chrono::minutes(1), [&] { return plant.peer(prefix).has_value(); }));
    dds::Guid writer;
    std::ranges::copy(prefix, writer.bytes.begin());
    EXPECT_FALSE(admission.admits(dds::topics::kPlantState, writer)) << "it is no plant";
    return admission.filter(dds::topics::kSimRequest)(writer);
  };
  EXPECT_TRUE(isHeard(getpid()));
  const pid_t ended = fork();
  if (ended == 0) _exit(0);
  ASSERT_EQ(waitpid(ended, nullptr, 0), ended);
  EXPECT_FALSE(isHeard(ended));
}

TEST(Admission, AWordCountsForWhoeverSaysItAndForAllFromTheSupervisor) {
  const dds::RunKey key = dds::RunKey::fresh();
  const auto member = [&](const std::string& name) {
    return dds::ParticipantOptions{.domain = test::ownDomain(),
                                   .partition = "lab/run",
                                   .cell = "lab",
                                   .run = "run",
                                   .service = name,
                                   .role = roleCalled(name),
                                   .key = key};
  };
  std::mutex mutex;
  std::condition_variable met;
  const dds::Participant plant(member(kPlantName), [&](const dds::Peer&) {
    const std::lock_guard lock(mutex);
    met.notify_all();
  });
  const Admission admission(plant, false, [](const std::string&) {});
  const dds::Participant pd(member("pd")), supervisor(member(kSupervisorName));
  const auto prefix = [](const dds::Participant& one) { return one.self().prefix; };
  {
    std::unique_lock lock(mutex);
    ASSERT_TRUE(met.wait_for(lock, std::chrono::minutes(1),
                             [&] { return plant.peer(prefix(pd)) && plant.peer(prefix(supervisor)); }));
  }
  const auto speaks = [&](const dds::Participant& one, const std::string& service) {
    dds::Guid writer;
    std::ranges::copy(prefix(one), writer.bytes.begin());
    return admission.speaksFor(writer, service);
  };
  EXPECT_TRUE(speaks(pd, "pd"));
  EXPECT_FALSE(speaks(pd, "force"));
  EXPECT_FALSE(speaks(pd, kSupervisorName));
  EXPECT_TRUE(speaks(supervisor, "pd"));
}

/// Nothing of the loop, and nothing that decides about it, may come from an operator.
TEST(Admission, EveryTopicThatIsNoRequestBelongsToServices) {
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    const bool is_request = std::string_view(topic.name).ends_with("_request");
    EXPECT_EQ(topic.written_by == kOperators, is_request) << topic.name;
  }
}

TEST(Admission, TheYoungerYieldsAndOnlyToWhoHasTheKey) {
  const auto peer = [](const std::string& run, const std::string& service, std::int64_t started_ns) {
    dds::Peer result;
    result.cell = "lab";
    result.run = run;
    result.service = service;
    result.started_ns = started_ns;
    return result;
  };
  const dds::Peer plant = peer("ours", kPlantName, 100);
  for (const bool has_begun : {false, true}) {
    EXPECT_TRUE(yieldsTo(plant, peer("ours", kPlantName, 99), true, has_begun));
    EXPECT_FALSE(yieldsTo(plant, peer("ours", kPlantName, 99), false, has_begun)) << "a stranger says so";
    EXPECT_FALSE(yieldsTo(plant, peer("ours", kPlantName, 101), true, has_begun)) << "the younger does";
    EXPECT_FALSE(yieldsTo(plant, peer("ours", kRecorderName, 99), true, has_begun));
    EXPECT_EQ(yieldsTo(plant, peer("theirs", kPlantName, 99), true, has_begun), !has_begun);
    EXPECT_FALSE(yieldsTo(plant, peer("theirs", kPlantName, 99), false, has_begun)) << "a stranger says so";
    const dds::Peer pd = peer("ours", "pd", 100);
    EXPECT_FALSE(yieldsTo(pd, peer("theirs", "pd", 99), true, has_begun)) << "each run has its own";
    dds::Peer elsewhere = peer("theirs", kPlantName, 99);
    elsewhere.cell = "other";
    EXPECT_FALSE(yieldsTo(plant, elsewhere, true, has_begun));
  }
}

}  // namespace
}  // namespace baton
