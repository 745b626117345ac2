/// How far the plant may run on, and what a reset waits for.
#include "credit.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "dds/codec.hpp"
#include "dds/topics.hpp"

namespace baton {
namespace {

Scenario scenarioOf(bool has_wall) {
  Scenario scenario;
  scenario.recording.credit_steps = 80;
  if (has_wall) scenario.walls.emplace_back();
  return scenario;
}

struct Fed {
  explicit Fed(bool has_wall = true) : credit(scenarioOf(has_wall)) {}

  template <class T>
  void came(const dds::Topic<T>& topic, std::uint64_t step) {
    T message;
    message.step(step);
    std::vector<std::byte> buffer(dds::maxPayload<T>());
    const auto place = credit.placeOf(topic.name);
    ASSERT_TRUE(place) << topic.name;
    credit.came(*place, dds::encode(message, std::span(buffer)));
  }
  void wholeStep(std::uint64_t step) {
    came(dds::topics::kPlantState, step);
    came(dds::topics::kReference, step + 1);
    if (credit.placeOf("contact")) came(dds::topics::kContact, step);
  }
  void rewind(msg::RewindPhase phase, std::uint32_t take, std::uint64_t at_step) {
    msg::Rewind rewind;
    rewind.phase(phase);
    rewind.take(take);
    rewind.at_step(at_step);
    credit.rewound(rewind);
  }
  StepCredit credit;
};

TEST(StepCredit, AStepIsAcknowledgedWhenAllOfItIsHere) {
  Fed fed;
  fed.came(dds::topics::kPlantState, 5);
  fed.came(dds::topics::kReference, 6);
  EXPECT_EQ(fed.credit.acknowledged(), 0u);
  fed.came(dds::topics::kContact, 4);
  EXPECT_EQ(fed.credit.acknowledged(), 4u);
  fed.came(dds::topics::kContact, 5);
  EXPECT_EQ(fed.credit.acknowledged(), 5u);
}

TEST(StepCredit, WithoutAWallNobodyWaitsForContacts) {
  Fed fed(false);
  EXPECT_FALSE(fed.credit.placeOf("contact"));
  EXPECT_FALSE(fed.credit.placeOf("joint_command"));
  fed.wholeStep(5);
  EXPECT_EQ(fed.credit.acknowledged(), 5u);
}

TEST(StepCredit, IsToldEverySoManyStepsAndWhenNothingMoreComes) {
  Fed fed;
  for (std::uint64_t step = 1; step < 10; ++step) fed.wholeStep(step);
  EXPECT_FALSE(fed.credit.isDue(false));
  EXPECT_TRUE(fed.credit.isDue(true));
  fed.wholeStep(10);
  EXPECT_TRUE(fed.credit.isDue(false));
  fed.credit.told();
  EXPECT_FALSE(fed.credit.isDue(true)) << "nothing new";
}

TEST(StepCredit, AResetIsAnsweredWhenTheOpenStepIsHereAndOnce) {
  Fed fed;
  fed.wholeStep(7);
  fed.rewind(msg::REWIND_PREPARE, 1, 8);
  EXPECT_FALSE(fed.credit.answer());
  fed.wholeStep(8);
  const auto prepared = fed.credit.answer();
  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->phase(), msg::REWIND_PREPARE);
  EXPECT_FALSE(fed.credit.answer());
  fed.rewind(msg::REWIND_COMMIT, 1, 8);
  EXPECT_EQ(fed.credit.acknowledged(), 0u) << "the run begins anew";
  EXPECT_EQ(fed.credit.take(), 1u);
  EXPECT_TRUE(fed.credit.answer());
}

TEST(StepCredit, AResetThatIsDroppedIsNotAnswered) {
  Fed fed;
  fed.wholeStep(8);
  fed.rewind(msg::REWIND_PREPARE, 1, 8);
  fed.rewind(msg::REWIND_CANCEL, 1, 8);
  EXPECT_FALSE(fed.credit.answer());
  EXPECT_EQ(fed.credit.acknowledged(), 8u);
}

TEST(StepCredit, TheRunLastsOnOverAReset) {
  Fed fed;
  fed.wholeStep(100);  // a branch begins in the middle
  EXPECT_EQ(fed.credit.elapsedSteps(), 0u);
  fed.wholeStep(130);
  EXPECT_EQ(fed.credit.elapsedSteps(), 30u);
  fed.rewind(msg::REWIND_COMMIT, 1, 130);
  fed.wholeStep(0);
  fed.wholeStep(5);
  EXPECT_EQ(fed.credit.elapsedSteps(), 35u);
  EXPECT_EQ(fed.credit.stateStep(), 5u);
}

}  // namespace
}  // namespace baton
