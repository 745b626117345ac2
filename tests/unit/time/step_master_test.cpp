/// The plant's step protocol, lived through by feeding it messages by hand.
#include "time/step_master.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

namespace baton {
namespace {

/// Feeds the open step all it needs and ends it if it may end. Returns what kept it, if anything.
Hold liveOneStep(StepMaster& master) {
  const std::uint64_t step = master.step();
  master.contactArrived(step);
  master.commandArrived(step);
  const Hold hold = master.hold();
  if (hold == Hold::kNone) master.advance();
  return hold;
}

TEST(StepMaster, LivesAWholeRunInLockstep) {
  StepMaster master({.end_step = 5, .needs_contact = true});
  EXPECT_EQ(master.phase(), SimPhase::kStarting);
  EXPECT_EQ(master.hold(), Hold::kNotStarted);
  master.start();
  for (std::uint64_t step = 0; step < 5; ++step) {
    EXPECT_EQ(master.phase(), SimPhase::kRunning);
    EXPECT_EQ(master.step(), step);
    EXPECT_EQ(master.hold(), Hold::kContact);
    EXPECT_TRUE(master.contactArrived(step));
    EXPECT_EQ(master.hold(), Hold::kCommand);
    EXPECT_TRUE(master.commandArrived(step));
    EXPECT_EQ(master.hold(), Hold::kNone);
    master.advance();
    EXPECT_FALSE(master.hasContact());
    EXPECT_FALSE(master.hasCommand());
  }
  EXPECT_EQ(master.step(), 5u);
  EXPECT_EQ(master.endStep(), 5u);
  EXPECT_EQ(master.phase(), SimPhase::kFinished);
  EXPECT_TRUE(master.isOver());
  EXPECT_EQ(master.hold(), Hold::kEnded);
}

TEST(StepMaster, InputsMayComeInAnyOrder) {
  StepMaster master({.needs_contact = true});
  master.start();
  EXPECT_TRUE(master.commandArrived(0));
  EXPECT_EQ(master.hold(), Hold::kContact);
  EXPECT_TRUE(master.contactArrived(0));
  EXPECT_EQ(master.hold(), Hold::kNone);
}

TEST(StepMaster, WithoutAnEnvironmentTheCommandIsEnough) {
  StepMaster master({.needs_contact = false});
  master.start();
  EXPECT_EQ(master.hold(), Hold::kCommand);
  master.commandArrived(0);
  EXPECT_EQ(master.hold(), Hold::kNone);
}

TEST(StepMaster, SamplesOfOtherStepsAreNotCounted) {
  StepMaster master({.needs_contact = true});
  master.start();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(liveOneStep(master), Hold::kNone);
  master.needOutgoing(true);
  for (const std::uint64_t wrong : {0ull, 2ull, 4ull, 1'000ull, ~0ull}) {
    EXPECT_FALSE(master.contactArrived(wrong));
    EXPECT_FALSE(master.commandArrived(wrong));
    EXPECT_FALSE(master.outgoingCommandArrived(wrong));
  }
  EXPECT_FALSE(master.hasContact());
  EXPECT_FALSE(master.hasCommand());
  EXPECT_FALSE(master.hasOutgoingCommand());
  EXPECT_EQ(master.hold(), Hold::kContact);
}

TEST(StepMaster, TheFirstStepOfAHandoverNeedsTheOutgoingCommandToo) {
  StepMaster master({});
  master.start();
  master.needOutgoing(true);
  master.commandArrived(0);
  EXPECT_EQ(master.hold(), Hold::kHandover);
  EXPECT_EQ(master.inputsHold(), Hold::kHandover);
  EXPECT_TRUE(master.outgoingCommandArrived(0));
  EXPECT_EQ(master.hold(), Hold::kNone);
  master.advance();
  master.commandArrived(1);
  EXPECT_EQ(master.hold(), Hold::kNone) << "needed at that step only";
}

TEST(StepMaster, AnOutgoingControllerThatIsGoneIsNotWaitedFor) {
  StepMaster master({});
  master.start();
  master.needOutgoing(true);
  master.commandArrived(0);
  master.needOutgoing(false);
  EXPECT_EQ(master.hold(), Hold::kNone);
}

TEST(StepMaster, AnUnacknowledgedSwapHoldsTheStep) {
  StepMaster master({});
  master.start();
  master.commandArrived(0);
  master.awaitSwap(true);
  EXPECT_EQ(master.hold(), Hold::kSwap);
  EXPECT_EQ(master.inputsHold(), Hold::kNone);
  master.awaitSwap(false);
  EXPECT_EQ(master.hold(), Hold::kNone);
}

TEST(StepMaster, RunsAtMostItsCreditPastTheRecorder) {
  constexpr std::uint64_t kCredit = 8;
  StepMaster master({.credit = kCredit});
  master.start();
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), kCredit);
  EXPECT_EQ(master.step(), kCredit);
  EXPECT_EQ(master.hold(), Hold::kRecorder);
  for (std::uint64_t acknowledged = 1; acknowledged < 50; ++acknowledged) {
    master.recorderAcknowledged(acknowledged);
    EXPECT_EQ(liveOneStep(master), Hold::kNone) << "one acknowledged, one released";
    EXPECT_EQ(liveOneStep(master), Hold::kRecorder);
    EXPECT_EQ(master.step(), acknowledged + kCredit);
  }
}

TEST(StepMaster, AcknowledgementsNeverGoBack) {
  StepMaster master({.credit = 4});
  master.start();
  master.recorderAcknowledged(3);
  master.recorderAcknowledged(1);
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 7u);
  EXPECT_EQ(master.step(), 7u);
}

TEST(StepMaster, ARecorderThatHasEverythingHoldsNothing) {
  StepMaster master({.credit = 4});
  master.start();
  master.recorderAcknowledged(~std::uint64_t{0});
  for (int i = 0; i < 100; ++i) ASSERT_EQ(liveOneStep(master), Hold::kNone);
}

TEST(StepMaster, WithoutARecorderThereIsNoCredit) {
  StepMaster master({.credit = 0});
  master.start();
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(liveOneStep(master), Hold::kNone);
}

TEST(StepMaster, PausesAndResumesAtTheOpenStep) {
  StepMaster master({});
  master.start();
  for (int i = 0; i < 3; ++i) liveOneStep(master);
  master.pause();
  EXPECT_EQ(master.phase(), SimPhase::kPaused);
  EXPECT_EQ(liveOneStep(master), Hold::kPaused);
  master.advance();
  EXPECT_EQ(master.step(), 3u);
  EXPECT_TRUE(master.hasCommand()) << "what arrives in a pause counts";
  master.resume();
  EXPECT_EQ(master.hold(), Hold::kNone);
  EXPECT_EQ(liveOneStep(master), Hold::kNone);
  EXPECT_EQ(master.step(), 4u);
}

TEST(StepMaster, StepsByExactlyAsManyAsAskedThenPauses) {
  StepMaster master({});
  master.start();
  master.pause();
  std::uint64_t expected = 0;
  for (const std::uint64_t count : {1ull, 2ull, 7ull, 100ull}) {
    master.stepBy(count);
    EXPECT_EQ(master.phase(), SimPhase::kRunning);
    while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), expected + count);
    expected += count;
    EXPECT_EQ(master.step(), expected);
    EXPECT_EQ(master.phase(), SimPhase::kPaused);
  }
  master.stepBy(0);
  EXPECT_EQ(master.phase(), SimPhase::kPaused);
}

TEST(StepMaster, AskingAgainAddsToTheStepsThatAreLeft) {
  StepMaster master({});
  master.start();
  master.stepBy(10);
  for (int i = 0; i < 4; ++i) liveOneStep(master);
  master.stepBy(3);
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 13u);
  EXPECT_EQ(master.step(), 13u);
}

TEST(StepMaster, MoreStepsThanCanBeCountedAreNotFewer) {
  StepMaster master({});
  master.start();
  for (int i = 0; i < 4; ++i) liveOneStep(master);
  master.stepBy(~std::uint64_t{0});
  for (int i = 0; i < 100; ++i) ASSERT_EQ(liveOneStep(master), Hold::kNone);
  master.stepBy(~std::uint64_t{0});
  EXPECT_EQ(liveOneStep(master), Hold::kNone);
}

TEST(StepMaster, ResumeAndPauseCancelTheStepsThatAreLeft) {
  StepMaster master({});
  master.start();
  master.stepBy(3);
  liveOneStep(master);
  master.pause();
  EXPECT_EQ(liveOneStep(master), Hold::kPaused);
  master.resume();
  for (int i = 0; i < 50; ++i) ASSERT_EQ(liveOneStep(master), Hold::kNone);
}

TEST(StepMaster, PausesAndEndsAtTheStepAskedFor) {
  StepMaster master({.end_step = 100});
  master.start();
  EXPECT_FALSE(master.pauseAt(0)) << "the open step";
  EXPECT_FALSE(master.pauseAt(100)) << "the end comes first";
  EXPECT_TRUE(master.pauseAt(7));
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 7u);
  EXPECT_EQ(master.step(), 7u);
  EXPECT_EQ(master.phase(), SimPhase::kPaused);
  EXPECT_TRUE(master.pauseAt(9)) << "asked for while paused, it holds after the next resume";
  master.resume();
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 9u);
  EXPECT_EQ(master.step(), 9u);
  EXPECT_FALSE(master.endAt(9));
  EXPECT_FALSE(master.endAt(101)) << "a run gets shorter, not longer";
  EXPECT_TRUE(master.endAt(12));
  master.resume();
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 12u);
  EXPECT_EQ(master.step(), 12u);
  EXPECT_EQ(master.phase(), SimPhase::kFinished);
}

TEST(StepMaster, AStepAndALaterPauseDoNotDisturbEachOther) {
  StepMaster master({});
  master.start();
  EXPECT_TRUE(master.pauseAt(20));
  master.stepBy(5);
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 5u);
  EXPECT_EQ(master.step(), 5u);
  master.stepBy(3);
  EXPECT_TRUE(master.pauseAt(30)) << "the later word holds, and the steps go on";
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 8u);
  EXPECT_EQ(master.step(), 8u);
  master.resume();
  while (liveOneStep(master) == Hold::kNone) ASSERT_LE(master.step(), 30u);
  EXPECT_EQ(master.step(), 30u);
}

TEST(StepMaster, BeginsWhereACheckpointIsWithCreditFromThere) {
  StepMaster master({.first_step = 5000, .end_step = 5002, .credit = 16});
  master.start();
  EXPECT_EQ(master.step(), 5000u);
  EXPECT_EQ(liveOneStep(master), Hold::kNone);
  EXPECT_EQ(liveOneStep(master), Hold::kNone);
  EXPECT_EQ(master.phase(), SimPhase::kFinished);
}

TEST(StepMaster, HoldsForARewindAndThenIsAtTheFirstStepAgain) {
  for (const bool paused : {false, true}) {
    StepMaster master({.end_step = 100, .credit = 16});
    master.start();
    for (int i = 0; i < 5; ++i) liveOneStep(master);
    if (paused) master.pause();
    master.holdForRewind(true);
    EXPECT_EQ(liveOneStep(master), Hold::kRewind);
    EXPECT_EQ(master.step(), 5u);
    master.rewind();
    EXPECT_EQ(master.step(), 0u);
    EXPECT_FALSE(master.hasCommand());
    EXPECT_EQ(master.phase(), paused ? SimPhase::kPaused : SimPhase::kRunning);
    master.resume();
    EXPECT_EQ(liveOneStep(master), Hold::kNone);
  }
}

TEST(StepMaster, TheOperatorCannotRunWhatHasNotStarted) {
  StepMaster master({});
  master.pause();
  master.resume();
  master.stepBy(5);
  master.advance();
  EXPECT_EQ(master.phase(), SimPhase::kStarting);
  EXPECT_EQ(master.step(), 0u);
}

TEST(StepMaster, TheEndComesBeforeThePauseOfASingleStep) {
  StepMaster master({.end_step = 2});
  master.start();
  master.stepBy(2);
  liveOneStep(master);
  liveOneStep(master);
  EXPECT_EQ(master.phase(), SimPhase::kFinished);
}

TEST(StepMaster, ARealtimeCallerAdvancesWithoutAnybody) {
  StepMaster master({.end_step = 10, .needs_contact = true, .credit = 2});
  master.start();
  for (int i = 0; i < 9; ++i) {
    EXPECT_NE(master.inputsHold(), Hold::kNone);
    master.advance();
  }
  EXPECT_EQ(master.step(), 9u);
  EXPECT_FALSE(master.isOver());
  master.advance();
  EXPECT_EQ(master.phase(), SimPhase::kFinished);
}

TEST(StepMaster, InputsHoldIgnoresTheOperatorAndTheRecorder) {
  StepMaster master({.credit = 1});
  master.start();
  liveOneStep(master);
  master.commandArrived(1);
  EXPECT_EQ(master.hold(), Hold::kRecorder);
  EXPECT_EQ(master.inputsHold(), Hold::kNone);
  master.pause();
  EXPECT_EQ(master.hold(), Hold::kPaused);
  EXPECT_EQ(master.inputsHold(), Hold::kNone);
}

TEST(StepMaster, NothingMovesAfterTheEndHoweverItCame) {
  for (const bool orderly : {true, false}) {
    for (int moment = 0; moment < 4; ++moment) {
      StepMaster master({});
      if (moment > 0) master.start();
      if (moment > 1) liveOneStep(master);
      if (moment > 2) master.pause();
      orderly ? master.finish() : master.abort();
      const SimPhase end = orderly ? SimPhase::kFinished : SimPhase::kAborted;
      const std::uint64_t step = master.step();
      master.start();
      master.pause();
      master.resume();
      master.stepBy(3);
      orderly ? master.abort() : master.finish();
      EXPECT_EQ(liveOneStep(master), Hold::kEnded);
      master.advance();
      EXPECT_EQ(master.phase(), end);
      EXPECT_EQ(master.step(), step);
    }
  }
}

TEST(StepMaster, KeepsItsRulesUnderAnyNews) {
  constexpr std::uint64_t kEnd = 40, kCredit = 6;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 generator(seed);
    StepMaster master({.end_step = kEnd, .needs_contact = seed % 2 == 0, .credit = kCredit});
    std::uint64_t acknowledged = 0;
    for (int i = 0; i < 3000; ++i) {
      const std::uint64_t before = master.step();
      const bool was_over = master.isOver();
      const std::uint64_t near = before + generator() % 3 - 1;
      switch (generator() % 9) {
        case 0: master.start(); break;
        case 1: master.contactArrived(near); break;
        case 2: master.commandArrived(near); break;
        case 3: master.recorderAcknowledged(acknowledged = std::max(acknowledged, before - before % 4)); break;
        case 4: master.stepBy(generator() % 4); break;
        case 5:
          if (generator() % 4 == 0) master.pause();
          break;
        case 6: master.resume(); break;
        case 7: master.needOutgoing(false); break;
        default:
          if (master.hold() == Hold::kNone) master.advance();
      }
      ASSERT_LE(master.step(), before + 1);
      ASSERT_LE(master.step(), acknowledged + kCredit);
      ASSERT_LE(master.step(), kEnd);
      ASSERT_EQ(master.isOver(), was_over || master.step() == kEnd);
      if (was_over) {
        ASSERT_EQ(master.step(), before);
      }
    }
    ASSERT_TRUE(master.isOver()) << "seed " << seed << " stopped at step " << master.step();
  }
}

TEST(StepMaster, EveryHoldHasWords) {
  for (const Hold hold : {Hold::kNone, Hold::kNotStarted, Hold::kEnded, Hold::kPaused, Hold::kContact, Hold::kCommand,
                          Hold::kHandover, Hold::kSwap, Hold::kRecorder}) {
    EXPECT_GT(std::string(toString(hold)).size(), 3u);
  }
}

}  // namespace
}  // namespace baton
