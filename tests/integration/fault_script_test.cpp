// Faults that the scenario wants, on real processes: they strike at their step, what follows is what the scenario says,
// and all of it repeats byte for byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "dds/typed.hpp"
#include "mcap/reader.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

constexpr std::uint64_t kAt = 400;  // impedance holds the baton from step 300 to 700
const std::string kBaton = "baton: {fallback: [pd], max_command: 1000}\n";

struct Outcome {
  nlohmann::json result;
  std::string recording;
  Streams loop;
};

Outcome runOf(const Bench& bench, const std::string& name, const std::string& scenario) {
  Outcome outcome;
  outcome.recording = (bench.folder() / (name + ".mcap")).string();
  const Finished finished =
      bench.baton({"run", bench.write(name + ".yaml", scenario), "--out", outcome.recording, "--json"});
  outcome.result = nlohmann::json::parse(finished.out, nullptr, false);
  EXPECT_FALSE(outcome.result.is_discarded()) << finished.out << finished.err;
  outcome.loop = loopStreams(outcome.recording);
  return outcome;
}

Outcome runWith(const Bench& bench, const std::string& name, const std::string& extra) {
  return runOf(bench, name, shortContact(extra));
}

std::vector<msg::PlantState> states(const Outcome& outcome) {
  return decodeStream<msg::PlantState>(outcome.loop.at({"plant_state", "plant"}));
}

void expectHolderFrom(const Outcome& outcome, std::uint64_t step, const std::string& holder) {
  for (const msg::PlantState& state : states(outcome)) {
    if (state.step() < kFirstSwap) continue;
    if (state.step() < step) {
      EXPECT_STREQ(state.holder().c_str(), "impedance") << state.step();
    } else if (state.step() < kSecondSwap) {
      EXPECT_STREQ(state.holder().c_str(), holder.c_str()) << state.step();
    }
  }
}

void expectTheSame(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.result.at("chain_hash"), b.result.at("chain_hash"));
  EXPECT_EQ(a.loop, b.loop);
}

/// What befalls the holder's command of one step, and where the baton is from then on.
struct HolderFault {
  std::string name;
  std::string fault;
  std::string reason;
};

class FaultOfTheHolder : public ::testing::TestWithParam<HolderFault> {};

TEST_P(FaultOfTheHolder, LosesItTheBatonAtTheNextStepAndRepeats) {
  const Bench bench;
  const std::string extra = kBaton + GetParam().fault;
  const Outcome first = runWith(bench, "first", extra);
  expectHolderFrom(first, kAt + 1, "pd");
  const auto& swaps = first.result.at("swaps");
  const auto failover =
      std::find_if(swaps.begin(), swaps.end(), [](const auto& swap) { return swap.at("incoming") == "pd"; });
  ASSERT_NE(failover, swaps.end()) << first.result;
  EXPECT_EQ(failover->at("at_step"), kAt + 1);
  EXPECT_NE(failover->at("reason").template get<std::string>().find(GetParam().reason), std::string::npos) << *failover;
  for (const msg::PlantState& state : states(first)) {
    for (const double effort : state.applied_effort()) ASSERT_TRUE(std::isfinite(effort) && std::abs(effort) < 1000.0);
  }
  expectTheSame(first, runWith(bench, "second", extra));
}

INSTANTIATE_TEST_SUITE_P(
    Each, FaultOfTheHolder,
    ::testing::Values(
        HolderFault{"nan", "faults: [{do: nan, service: impedance, topic: joint_command, at_s: 0.2}]\n", "not finite"},
        HolderFault{"above_the_bound",
                    "faults: [{do: bias, service: impedance, topic: joint_command, at_s: 0.2, by: 1.0e+6}]\n",
                    "max_command"},
        HolderFault{"killed", "faults: [{do: kill, service: impedance, at_s: 0.2}]\n", "signal 9"},
        HolderFault{"stopped_for_good",
                    "late: {policy: fallback, after_s: 10}\nfaults: [{do: stop, service: impedance, at_s: 0.2}]\n",
                    "silent for too long"},
        HolderFault{"dropped",
                    "late: {policy: fallback, after_s: 10}\n"
                    "faults: [{do: drop, service: impedance, topic: joint_command, at_s: 0.2}]\n",
                    "silent for too long"}),
    [](const auto& fault) { return fault.param.name; });

TEST(FaultScript, WhatOnlyTakesTimeChangesNothingInLockstep) {
  const Bench bench;
  const Outcome undisturbed = runWith(bench, "undisturbed", "");
  ASSERT_EQ(undisturbed.result.at("exit_code"), 0) << undisturbed.result;
  const Outcome disturbed = runWith(
      bench, "disturbed",
      "faults:\n"
      "  - {do: delay, service: environment, topic: contact, at_s: 0.1, until_s: 0.105, for_s: 0.02}\n"
      "  - {do: delay, service: tracking, topic: joint_command, at_s: 0.05, for_s: 0.1}\n"
      "  - {do: duplicate, service: impedance, topic: joint_command, at_s: 0.2, until_s: 0.3, probability: 0.3}\n"
      "  - {do: duplicate, service: trajectory, topic: reference, at_s: 0.1, until_s: 0.3}\n"
      "  - {do: stop, service: trajectory, at_s: 0.25, for_s: 0.2}\n");
  EXPECT_EQ(disturbed.result.at("exit_code"), 0) << disturbed.result;
  EXPECT_EQ(disturbed.result.at("chain_hash"), undisturbed.result.at("chain_hash"));
}

TEST(FaultScript, AWrongMeasurementIsWrongForEverybodyAndAsMuchAsWanted) {
  const Bench bench;
  const Outcome undisturbed = runWith(bench, "undisturbed", "");
  const std::string biased = "faults: [{do: bias, service: plant, topic: plant_state, at_s: 0.2, by: [0.01, 0, 0]}]\n";
  const Outcome disturbed = runWith(bench, "disturbed", biased);
  const auto good = states(undisturbed);
  const auto bad = states(disturbed);
  ASSERT_GT(std::min(good.size(), bad.size()), kAt + 1);
  for (std::size_t step = 0; step < kAt; ++step) ASSERT_EQ(good[step].position(), bad[step].position());
  EXPECT_EQ(bad[kAt].position()[0], good[kAt].position()[0] + 0.01);
  EXPECT_EQ(bad[kAt].position()[1], good[kAt].position()[1]);
  EXPECT_NE(bad[kAt + 1].applied_effort(), good[kAt + 1].applied_effort()) << "the law answered what it was told";
  EXPECT_NEAR(bad[kAt + 1].position()[0], good[kAt + 1].position()[0], 1e-3) << "the arm itself was not moved";
}

TEST(FaultScript, AStuckForceStaysAsItWasUntilTheFaultIsOver) {
  const Bench bench;
  const Outcome outcome = runWith(
      bench, "stuck", "faults: [{do: stuck, service: environment, topic: contact, at_s: 0.3, until_s: 0.34}]\n");
  const auto contacts = decodeStream<msg::Contact>(outcome.loop.at({"contact", "environment"}));
  constexpr std::size_t kFrom = 600;
  constexpr std::size_t kUntil = 680;
  ASSERT_GT(contacts.size(), kUntil);
  ASSERT_GT(contacts[kFrom - 1].force()[2], 0.0) << "in contact";
  for (std::size_t step = kFrom; step < kUntil; ++step) EXPECT_EQ(contacts[step].force(), contacts[kFrom - 1].force());
  EXPECT_NE(contacts[kUntil].force(), contacts[kFrom - 1].force());
}

/// What its readers cannot use is the sender's fault, whatever the policy is for those who are late.
struct BadSender {
  std::string service;
  std::string topic;
  std::string field;
};

struct Policy {
  std::string name;
  std::string text;
};
const Policy kPolicies[] = {
    {"wait", "late: {policy: wait}\n"},
    {"abort", "late: {policy: abort, after_s: 10}\n"},
    {"fallback", "late: {policy: fallback, after_s: 10}\nbaton: {fallback: [pd]}\n"},
    {"realtime", "mode: realtime\nmax_missed_steps: 1000\nbaton: {fallback: [pd]}\n"},
};

class FaultOfASender : public ::testing::TestWithParam<std::tuple<BadSender, Policy>> {};

TEST_P(FaultOfASender, EndsTheRunInItsNameAtItsStep) {
  const auto& [sender, policy] = GetParam();
  const Bench bench;
  const std::string fault =
      "faults: [{do: nan, service: " + sender.service + ", topic: " + sender.topic + ", at_s: 0.2}]\n";
  // In real time the fault ends the run, however late a busy machine hears of it.
  const Outcome outcome = policy.name == "realtime" ? runOf(bench, "nan", restingContact(policy.text + fault))
                                                    : runWith(bench, "nan", policy.text + fault);
  EXPECT_EQ(outcome.result.at("exit_code"), 4) << outcome.result;
  const std::string reason = outcome.result.at("reason");
  const std::string said = sender.service + " sent " + sender.topic + " of step " + std::to_string(kAt);
  EXPECT_TRUE(reason.starts_with(said)) << reason;
  EXPECT_NE(reason.find(sender.field + " is not finite"), std::string::npos) << reason;
  const Finished events = bench.baton({"bag", "cat", outcome.recording, "--topics", "event"});
  EXPECT_NE(events.out.find(said), std::string::npos) << events.out;
  const auto& swaps = outcome.result.at("swaps");
  EXPECT_TRUE(std::none_of(swaps.begin(), swaps.end(), [](const auto& swap) { return swap.at("incoming") == "pd"; }))
      << "an innocent lost the baton: " << swaps;
  if (policy.name != "realtime") {
    EXPECT_EQ(outcome.result.at("steps"), kAt);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, FaultOfASender,
                         ::testing::Combine(::testing::Values(BadSender{"trajectory", "reference", "position"},
                                                              BadSender{"plant", "plant_state", "position"},
                                                              BadSender{"environment", "contact", "force"}),
                                            ::testing::ValuesIn(kPolicies)),
                         [](const auto& given) {
                           return std::get<0>(given.param).service + "_" + std::get<1>(given.param).name;
                         });

TEST(FaultScript, AHolderThatMeetsASingularityLosesTheBatonForThat) {
  // At a reach of -0.55 m the tip is on the axis that the first joint turns about.
  std::string text = shortContact("baton: {fallback: [pd]}\n");
  text.erase(text.find("swaps:"), text.find("baton:") - text.find("swaps:"));
  const std::string position = "[0.42, 0.15, 0.08]";
  for (std::size_t at = text.find(position); at != std::string::npos; at = text.find(position)) {
    text.replace(at, position.size(), "[0.4, 0.1, -0.55]");
  }
  const Bench bench;
  const std::string recording = (bench.folder() / "singular.mcap").string();
  const Finished run = bench.baton({"run", bench.write("singular.yaml", text), "--out", recording});
  EXPECT_EQ(run.exit_code, 1) << run.out << run.err;
  EXPECT_NE(run.out.find("its law has no effort to give: a singular configuration at step 0"), std::string::npos)
      << run.out;
  const Finished events = bench.baton({"bag", "cat", recording, "--topics", "event"});
  EXPECT_NE(events.out.find("tracking: its law has no effort to give: a singular configuration"), std::string::npos)
      << events.out;
}

TEST(FaultScript, AKilledRecorderLeavesAFileThatIsReadUpToTheFault) {
  const Bench bench;
  const Outcome outcome = runWith(bench, "killed", "faults: [{do: kill, service: recorder, at_s: 0.2}]\n");
  EXPECT_NE(outcome.result.at("exit_code"), 0);
  EXPECT_FALSE(mcap::Reader(outcome.recording).info().is_complete);
}

}  // namespace
}  // namespace baton::test
