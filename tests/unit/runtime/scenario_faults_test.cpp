/// What a scenario lets go wrong: read, or refused with the reason.
#include <gtest/gtest.h>

#include "bad_input.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

using test::BadInput;
using test::refusal;
using test::replaced;
using test::rppScenario;

const std::string kFaulty = R"(name: faulty
robot: rpp.yaml
step_s: 0.001
duration_s: 5
environment: {walls: [{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 200}]}
trajectory: {waypoints: [{time_s: 0, position: [0, 0, 0]}]}
controllers: [{name: first, law: joint_pd}, {name: second, law: joint_pd}]
active: first
faults:
  - {do: nan, service: first, topic: joint_command, at_s: 1}
  - {do: bias, service: environment, topic: contact, at_s: 1, until_s: 1.5, by: [0.5, 0, -1]}
  - {do: bias, service: plant, topic: plant_state, at_s: 2, by: 0.01}
  - {do: drop, service: second, topic: shadow_command, at_s: 1, until_s: 2, probability: 0.25, seed: 7}
  - {do: delay, service: trajectory, topic: reference, at_s: 1, for_s: 0.05}
  - {do: stop, service: second, at_s: 3, for_s: 2}
  - {do: kill, service: recorder, at_s: 4}
)";

Scenario parse(const std::string& text) { return rppScenario("faulty.yaml", text); }

TEST(ScenarioFaults, NothingIsSavedWhereAMessageIsStuck) {
  const Scenario scenario = parse(replaced(kFaulty, "do: nan, service: first, topic: joint_command, at_s: 1",
                                           "do: stuck, service: environment, topic: contact, at_s: 1, until_s: 1.5") +
                                  "recording: {checkpoint_s: 0.25}\n");
  for (const std::uint64_t step : {250U, 750U, 1500U, 5000U}) EXPECT_TRUE(scenario.hasCheckpointAt(step)) << step;
  for (const std::uint64_t step : {0U, 1000U, 1250U, 1501U}) EXPECT_FALSE(scenario.hasCheckpointAt(step)) << step;
}

TEST(ScenarioFaults, AreReadAsTheyAreWritten) {
  const std::vector<Fault> faults = parse(kFaulty).faults;
  ASSERT_EQ(faults.size(), 7U);
  EXPECT_EQ(faults[0].kind, FaultKind::kNan);
  EXPECT_EQ(faults[0].service, "first");
  EXPECT_EQ(faults[0].topic, "joint_command");
  EXPECT_EQ(faults[0].from_step, 1000U);
  EXPECT_EQ(faults[0].until_step, 1001U) << "one step when it has no end";
  EXPECT_EQ(faults[0].probability, 1.0);
  EXPECT_EQ(faults[1].until_step, 1500U);
  EXPECT_EQ(faults[1].by, (std::vector<double>{0.5, 0.0, -1.0}));
  EXPECT_EQ(faults[2].by, std::vector<double>{0.01});
  EXPECT_EQ(faults[3].probability, 0.25);
  EXPECT_EQ(faults[3].seed, 7U);
  EXPECT_EQ(faults[4].seconds, 0.05);
  EXPECT_EQ(faults[5].kind, FaultKind::kStop);
  EXPECT_EQ(faults[5].seconds, 2.0);
  EXPECT_TRUE(faults[5].topic.empty());
  EXPECT_EQ(faults[6].service, "recorder");
}

class BadFault : public testing::TestWithParam<BadInput> {};

TEST_P(BadFault, IsRefusedWithItsPlace) {
  const std::string text = replaced(kFaulty, GetParam().from, GetParam().to);
  expectMessage(refusal([&] { return parse(text); }), "faulty.yaml", text, GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadFault,
    testing::Values(
        BadInput{"Kind", "do: nan", "do: nap", "do: nap", "nan", "nap"},
        BadInput{"Service", "service: first", "service: third", "service: third", "second", "third"},
        BadInput{"TopicOfSomebodyElse", "topic: contact", "topic: reference", "topic: reference", "contact",
                 "reference"},
        BadInput{"RecorderHasNoTopic", "{do: kill, service: recorder", "{do: drop, topic: event, service: recorder",
                 "do: drop, topic: event", "no topic", "event"},
        BadInput{"PlantsWordIsNotLost", "do: bias, service: plant", "do: drop, service: plant",
                 "do: drop, service: plant", "nan, stuck or bias", "drop"},
        BadInput{"FirstStep", "at_s: 3", "at_s: 0", "at_s: 0", "after the first step", "0"},
        BadInput{"EndBeforeBegin", "until_s: 1.5", "until_s: 0.5", "until_s: 0.5", "after at_s", "0.5"},
        BadInput{"BetweenSteps", "at_s: 3", "at_s: 3.0004", "at_s: 3.0004", "whole number of steps", "3.0004"},
        BadInput{"Probability", "probability: 0.25", "probability: 1.25", "probability: 1.25", "from 0 to 1", "1.25"},
        BadInput{"BiasOfTheWrongSize", "by: [0.5, 0, -1]", "by: [0.5, 0]", "by: [0.5, 0]", "3", "2"},
        BadInput{"NoBias", ", by: 0.01", "", "service: plant", "by", ""},
        BadInput{"NoDelay", ", for_s: 0.05", "", "do: delay", "for_s", ""},
        BadInput{"UnusedKey", "service: recorder, at_s: 4", "service: recorder, at_s: 4, probability: 0.5",
                 "service: recorder", "no probability", "0.5"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace baton
