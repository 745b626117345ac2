// What a person is told of a run that was done again.
#include "rerun.hpp"

#include <gtest/gtest.h>

namespace baton::test {
namespace {

/// Of a recording of 1000 steps, of which the repetition has 400.
Rerun shortened() {
  Rerun made;
  made.steps = 1000;
  made.hash = 7;
  made.first_missing = 400;
  made.result = {{"reason", "the plant died"}};
  return made;
}

TEST(Rerun, ThatEndedEarlyDiffers) {
  const Rerun made = shortened();
  EXPECT_FALSE(made.isIdentical());
  EXPECT_EQ(made.text(), "differs: ends before step 400: the plant died");
}

TEST(Rerun, ThatWasInterruptedIsNeitherIdenticalNorDifferent) {
  Rerun made = shortened();
  made.was_interrupted = true;
  EXPECT_FALSE(made.isIdentical());
  EXPECT_EQ(made.text(), "interrupted before step 400: identical up to there");
}

TEST(Rerun, ThatHadPartedBeforeItWasInterruptedDiffers) {
  Rerun made = shortened();
  made.was_interrupted = true;
  made.comparison.parting = Parting{.step = 12, .topic = "plant_state"};
  EXPECT_EQ(made.text(), "differs: first at step 12 in plant_state");
}

TEST(Rerun, WithEveryStepIsIdenticalThoughASignalCameAfterTheLast) {
  Rerun made = shortened();
  made.first_missing.reset();
  made.was_interrupted = true;
  EXPECT_TRUE(made.isIdentical());
  EXPECT_EQ(made.text(), "identical: 1000 steps, 0 decisions taken from the recording, hash 7");
}

}  // namespace
}  // namespace baton::test
