// Handing over on real processes: options, dry runs, what is told of it, and the cases that are easy to get wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "dds/typed.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

/// The short scenario at rest in free space, at the pace of a clock, without an end. `sagging` lacks the weight's
/// torque.
std::string atRest(const std::string& extra = "") {
  std::string text = restingContact("rate: 1\n" + extra);
  return text.insert(text.find("active: tracking\n"),
                     "  - {name: sagging, law: joint_pd, parameters: {gravity: none}}\n");
}

double largest(const nlohmann::json& numbers) {
  double result = 0.0;
  for (const auto& number : numbers) result = std::max(result, std::abs(number.get<double>()));
  return result;
}

bool says(const nlohmann::json& text, const std::string& what) {
  return text.get<std::string>().find(what) != std::string::npos;
}

TEST(Handover, OfManyForTheSameStepEachIsAnswered) {
  const Bench bench;
  std::string swaps = "swaps:\n";
  for (int i = 0; i < 40; ++i) swaps += "  - {at_s: 0.15, to: tracking, expect: any}\n";  // holds it already
  swaps += "  - {at_s: 0.15, to: impedance, expect: any}\n";
  const std::string scenario = endlessContact("duration_s: 0.5\n" + swaps);
  const nlohmann::json result = bench.batonJson({"run", bench.write("many.yaml", scenario), "--json"});
  ASSERT_EQ(result.at("exit_code"), 0) << result;
  ASSERT_EQ(result.at("swaps").size(), 41U);
  EXPECT_TRUE(result.at("swaps").back().at("done")) << result.at("swaps").back();
}

TEST(Handover, ADryRunTellsWhatWouldComeOfItAndNothingHappens) {
  const Bench bench;
  const LiveRun run(bench, atRest());
  const nlohmann::json fine = bench.batonJson({"swap", "pd", "--dry-run", "--json"});
  EXPECT_TRUE(fine.at("feasible")) << fine;
  EXPECT_FALSE(fine.at("done"));
  EXPECT_EQ(fine.at("forecast_effort_step").size(), 3U);
  const Finished refused = bench.baton({"swap", "force", "--dry-run"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.out.find("touches nothing"), std::string::npos) << refused.out;
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("holder"), "tracking");
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_TRUE(result.at("swaps").empty()) << result;
}

TEST(Handover, ControllersShowWhatAHandoverNowWouldChangeAndWhyTheLastWasRefused) {
  const Bench bench;
  const LiveRun run(bench, atRest());
  EXPECT_EQ(bench.baton({"swap", "force"}).exit_code, 1);
  nlohmann::json controllers;
  ASSERT_TRUE(eventually([&] {
    controllers = bench.batonJson({"controllers", "--json"});
    return std::ranges::none_of(
        controllers, [](const auto& one) { return one.at("name") != "tracking" && one.at("forecast").is_null(); });
  })) << controllers;
  ASSERT_EQ(controllers.size(), 5U);
  for (const auto& one : controllers) {
    const std::string name = one.at("name");
    if (name == "tracking") {
      EXPECT_EQ(one.at("state"), "active");
      EXPECT_TRUE(one.at("forecast").is_null());
      continue;
    }
    EXPECT_EQ(one.at("state"), "standby") << one;
    EXPECT_EQ(one.at("forecast").at("feasible"), name != "force") << one;
    EXPECT_EQ(one.at("last_refusal").is_null(), name != "force") << one;
    if (name == "sagging") {
      EXPECT_GT(largest(one.at("forecast").at("effort_step")), 0.1) << one;
    }
    if (name == "force") {
      EXPECT_TRUE(says(one.at("last_refusal").at("reason"), "touches nothing")) << one;
    }
  }
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(Handover, OptionsChooseBlendAndHelpAndTheMeterTellsTheDifference) {
  const Bench bench;
  const LiveRun run(bench, atRest());
  const nlohmann::json soft = bench.batonJson({"swap", "sagging", "--blend", "50", "--json"});
  ASSERT_TRUE(soft.at("done")) << soft;
  EXPECT_EQ(soft.at("blend_steps"), 100);
  EXPECT_GT(largest(soft.at("raw_effort_step")), 0.1);
  EXPECT_LT(largest(soft.at("applied_effort_step")), 1e-6) << "at rest nothing changes at the first step";
  EXPECT_EQ(soft.at("report").at("rate_limit_hits"), 0) << soft;
  EXPECT_EQ(soft.at("report").at("steps"), 200) << "as long as the scenario's blend at least";
  EXPECT_GT(std::abs(soft.at("report").at("blend_energy_J").get<double>()), 0.0);

  const nlohmann::json back = bench.batonJson({"swap", "tracking", "--json"});
  ASSERT_TRUE(back.at("done")) << back;
  run.waitForStep(back.at("at_step").get<std::uint64_t>() + 4000);  // at rest again, or the torque still changes
  const nlohmann::json hard = bench.batonJson({"swap", "sagging", "--hard", "--json"});
  ASSERT_TRUE(hard.at("done")) << hard;
  EXPECT_EQ(hard.at("blend_steps"), 0);
  for (std::size_t joint = 0; joint < 3; ++joint) {
    EXPECT_NEAR(hard.at("applied_effort_step").at(joint).get<double>(),
                -hard.at("raw_effort_step").at(joint).get<double>(), 1e-3)
        << "the joints feel all of it";
  }
  EXPECT_GT(hard.at("report").at("rate_limit_hits"), 0) << hard;
  EXPECT_EQ(hard.at("report").at("blend_energy_J"), 0.0);
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(Handover, IsRefusedToItselfToNobodyAndForStepsThatHaveGoneBy) {
  const Bench bench;
  const LiveRun run(bench, atRest());
  run.waitForStep(10);
  EXPECT_TRUE(says(bench.batonJson({"swap", "tracking", "--json"}).at("reason"), "holds the baton already"));
  EXPECT_TRUE(says(bench.batonJson({"swap", "nobody", "--json"}).at("reason"), "nobody"));
  EXPECT_TRUE(says(bench.batonJson({"swap", "pd", "--at", "3", "--json"}).at("reason"), "too near"));
  EXPECT_EQ(bench.baton({"swap", "pd", "--at", "0"}).exit_code, 2);
  EXPECT_EQ(bench.baton({"swap", "pd", "--at", "9", "--at-time", "1"}).exit_code, 2);
  EXPECT_EQ(bench.baton({"swap", "pd", "--blend", "-1"}).exit_code, 2);
  EXPECT_EQ(bench.baton({"swap", "pd", "--blend", "50", "--hard"}).exit_code, 2);
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("holder"), "tracking");
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(Handover, AskedForDuringAPauseTakesPlaceBehindIt) {
  const Bench bench;
  const LiveRun run(bench, atRest(), {"--paused"});
  ASSERT_EQ(bench.baton({"sim", "step", "100"}).exit_code, 0);
  // Nobody waits for the outcome here: it cannot come before the run goes on.
  std::thread asking([&] { (void)bench.baton({"swap", "pd", "--at", "150"}); });
  const nlohmann::json would = bench.batonJson({"swap", "pd", "--dry-run", "--json"});
  EXPECT_TRUE(would.at("feasible")) << "a dry run is answered in a pause too: " << would;
  EXPECT_EQ(would.at("forecast_step"), 100) << would;
  asking.join();
  ASSERT_EQ(bench.baton({"sim", "step", "100"}).exit_code, 0);
  const nlohmann::json status = bench.batonJson({"status", "--json"});
  EXPECT_EQ(status.at("holder"), "pd");
  EXPECT_EQ(status.at("step"), 200);
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  ASSERT_EQ(result.at("swaps").size(), 1U) << result;
  EXPECT_EQ(result.at("swaps").at(0).at("at_step"), 150);
}

TEST(Handover, OfTwoAtOnceOneIsDoneAndTheOtherRefused) {
  const Bench bench;
  const LiveRun run(bench, atRest(), {"--paused"});
  ASSERT_EQ(bench.baton({"sim", "step", "100"}).exit_code, 0);
  std::thread first([&] { (void)bench.baton({"swap", "pd", "--at", "150"}); });
  std::thread second([&] { (void)bench.baton({"swap", "impedance", "--at", "152"}); });
  first.join();
  second.join();
  // Neither is decided in the pause. The later one falls into the earlier one's handover.
  ASSERT_EQ(bench.baton({"sim", "step", "100"}).exit_code, 0);
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  ASSERT_EQ(result.at("swaps").size(), 2U) << result;
  for (const auto& swap : result.at("swaps")) {
    EXPECT_EQ(swap.at("done"), swap.at("incoming") == "pd") << swap;
    if (swap.at("incoming") == "impedance") {
      EXPECT_TRUE(says(swap.at("reason"), "under way")) << swap;
    }
  }
}

/// The short scenario with one planned handover, and what goes wrong around it.
nlohmann::json runWithSwap(const Bench& bench, const std::string& swap, const std::string& extra) {
  std::string text = shortContact();
  text.erase(text.find("swaps:"));
  const std::string file = bench.write("short.yaml", text + "swaps: [" + swap + "]\n" + extra);
  return nlohmann::json::parse(bench.baton({"run", file, "--json"}).out);
}

TEST(Handover, InTheLastStepIsDoneAndHasItsOutcome) {
  const Bench bench;
  const nlohmann::json result = runWithSwap(bench, "{at_s: 0.4995, to: pd}", "");
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  ASSERT_EQ(result.at("swaps").size(), 1U) << result;
  EXPECT_TRUE(result.at("swaps").at(0).at("done"));
  EXPECT_EQ(result.at("swaps").at(0).at("at_step"), kShortSteps - 1);
  EXPECT_EQ(result.at("swaps").at(0).at("applied_effort_step").size(), 3U) << "its step was taken";
}

struct Death {
  std::string name;
  std::string at_s;  // the handover is for step 400: forecast at 395, committed there
  std::string who;
  bool done;
  std::string holder;  // in the end
};

class DiesAround : public ::testing::TestWithParam<Death> {};

TEST_P(DiesAround, AHandoverAndTheRunGoesOnAsItMust) {
  const Bench bench;
  const nlohmann::json result =
      runWithSwap(bench, "{at_s: 0.2, to: pd" + std::string(GetParam().done ? "}" : ", expect: refused}"),
                  "baton: {margin_steps: 5, fallback: [impedance]}\n"
                  "faults: [{do: kill, service: " +
                      GetParam().who + ", at_s: " + GetParam().at_s + "}]\n");
  ASSERT_FALSE(result.at("swaps").empty()) << result;
  const auto& planned = *std::find_if(result.at("swaps").begin(), result.at("swaps").end(),
                                      [](const auto& swap) { return swap.at("plan_id") != 0; });
  EXPECT_EQ(planned.at("done"), GetParam().done) << result;
  EXPECT_EQ(result.at("holder"), GetParam().holder) << result;
  EXPECT_EQ(result.at("steps"), kShortSteps) << result;
}

INSTANTIATE_TEST_SUITE_P(Each, DiesAround,
                         ::testing::Values(Death{"incoming_before_the_forecast", "0.197", "pd", false, "tracking"},
                                           Death{"incoming_at_the_forecast", "0.1975", "pd", false, "tracking"},
                                           Death{"incoming_before_its_first_step", "0.2", "pd", true, "impedance"},
                                           Death{"outgoing_after_the_commit", "0.199", "tracking", false, "impedance"},
                                           Death{"outgoing_in_its_last_command", "0.2", "tracking", true, "pd"}),
                         [](const auto& death) { return death.param.name; });

}  // namespace
}  // namespace baton::test
