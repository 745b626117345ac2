/// What happens to the baton when controllers fail, before, during and after a handover.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "arbiter_run.hpp"
#include "base/state_archive.hpp"
#include "time/baton_arbiter.hpp"

namespace baton::test {
namespace {

using Kinds = std::vector<Kind>;

TEST(Failover, TheStepAfterTheFailureBelongsToTheFirstFitFallback) {
  ArbiterRun run;
  run.in_contact = true;
  run.runTo(7);
  run.fail(kFirst);
  EXPECT_EQ(run.arbiter.holder(), kFirst) << "the open step was its";
  EXPECT_EQ(run.next(), kForce);
  ASSERT_EQ(run.kinds(), Kinds{Kind::kDone});
  EXPECT_EQ(run.lastPlan().request_id, 0u);
  EXPECT_EQ(run.lastPlan().plan_id, 0u);
  EXPECT_EQ(run.lastPlan().outgoing, kFirst);
  EXPECT_EQ(run.lastPlan().incoming, kForce);
  EXPECT_EQ(run.lastPlan().decided_at_step, 7u);
  EXPECT_EQ(run.lastPlan().at_step, 8u);
  EXPECT_EQ(run.lastReason(), "failover: its process has ended at step 7");
  EXPECT_TRUE(run.arbiter.changedAt(8));
  EXPECT_FALSE(run.arbiter.changedAt(7));
  EXPECT_EQ(run.arbiter.outgoingAt(8), kBrake) << "who failed sends no last command";
  EXPECT_EQ(run.next(), kForce);
  EXPECT_EQ(run.actions.size(), 1u) << "once";
}

TEST(Failover, SkipsForceLawsOutOfContact) {
  ArbiterRun run;
  run.fail(kFirst);
  EXPECT_EQ(run.next(), kSpare);
}

TEST(Failover, SkipsFallbacksThatHaveFailedThemselves) {
  ArbiterRun run;
  run.in_contact = true;
  run.fail(kForce);
  run.fail(kFirst);
  EXPECT_EQ(run.next(), kSpare);
}

TEST(Failover, TheBrakeIsTheLastResort) {
  ArbiterRun run;
  run.fail(kFirst);
  EXPECT_EQ(run.next(), kSpare);
  run.fail(kSpare);
  EXPECT_EQ(run.next(), kBrake) << "only the force law is left, and nothing is touched";
  EXPECT_EQ(run.lastPlan().outgoing, kSpare);
  EXPECT_EQ(run.lastPlan().incoming, kBrake);
  EXPECT_TRUE(run.arbiter.changedAt(run.step));
  run.fail(kBrake);
  EXPECT_EQ(run.next(), kBrake) << "the brake cannot fail";
}

TEST(Failover, RemembersWhenWhoFailedUntilItReturnsAndThenItOnlyStandsBy) {
  ArbiterRun run;
  run.runTo(7);
  run.fail(kFirst);
  EXPECT_EQ(run.arbiter.failedAt(kFirst), 7u);
  run.arbiter.memberReturned(kFirst);
  EXPECT_TRUE(run.arbiter.hasFailed(kFirst)) << "the open step is still its own";
  EXPECT_EQ(run.next(), kSpare);
  run.arbiter.memberReturned(kFirst);
  EXPECT_FALSE(run.arbiter.hasFailed(kFirst));
  EXPECT_EQ(run.next(), kSpare) << "it does not take the baton by itself";
  run.handOverUpTo(kFirst);
  EXPECT_EQ(run.next(), kFirst);
  run.fail(kFirst);
  run.arbiter.rewind({kFirst});
  EXPECT_TRUE(run.arbiter.hasFailed(kFirst));
  EXPECT_EQ(run.arbiter.failedAt(kFirst), 0u) << "steps are counted anew";
}

TEST(Failover, BehindAResetOnlyWhoIsAbsentHasFailed) {
  ArbiterRun run;
  run.runTo(7);
  run.fail(kFirst);
  run.fail(kSecond);
  run.arbiter.rewind({});
  EXPECT_FALSE(run.arbiter.hasFailed(kFirst) || run.arbiter.hasFailed(kSecond));
  EXPECT_EQ(run.arbiter.open(0), kFirst);
  run.drain();
  run.arbiter.rewind({kSecond, kFirst});
  EXPECT_TRUE(run.arbiter.hasFailed(kSecond));
  EXPECT_EQ(run.arbiter.open(0), kSpare) << "no step is its own";
}

TEST(Failover, FromTheBrakeAFitControllerCanTakeOver) {
  ArbiterRun run;
  run.fail(kFirst);
  run.next();
  run.fail(kSpare);
  run.next();
  run.handOverUpTo(kSecond);
  EXPECT_EQ(run.next(), kSecond);
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kBrake);
}

TEST(Failover, AHolderOutsideTheFallbackListIsFollowedByIt) {
  ArbiterConfig config = fourControllers();
  config.fallback = {};
  ArbiterRun run(config);
  run.fail(kFirst);
  EXPECT_EQ(run.next(), kBrake);
}

TEST(Failover, AFailureIsCountedOnce) {
  ArbiterRun run;
  run.fail(kFirst);
  run.fail(kFirst);
  run.next();
  run.fail(kFirst);
  run.next();
  EXPECT_EQ(run.kinds(), Kinds{Kind::kDone});
  EXPECT_TRUE(run.arbiter.hasFailed(kFirst));
  EXPECT_FALSE(run.arbiter.hasFailed(kSecond));
  EXPECT_FALSE(run.arbiter.hasFailed(kBrake));
}

TEST(Failover, UnknownMembersCannotFail) {
  ArbiterRun run;
  for (const int member : {-5, kBrake, 4, 1'000}) run.fail(member);
  EXPECT_EQ(run.next(), kFirst);
  EXPECT_TRUE(run.actions.empty());
}

TEST(Failover, ABystandersFailureChangesNothingNow) {
  ArbiterRun run;
  run.request(kSecond);
  run.fail(kSpare);
  EXPECT_EQ(run.kinds(), Kinds{Kind::kPrepare});
  EXPECT_EQ(run.next(), kFirst);
}

TEST(Failover, TheHoldersFailureEndsAPlanThatIsBeingPrepared) {
  ArbiterRun run;
  run.request(kSecond);
  run.fail(kFirst);
  EXPECT_EQ(run.kinds(), (Kinds{Kind::kPrepare, Kind::kCancel, Kind::kRefused}));
  EXPECT_EQ(run.lastPlan().request_id, 1u);
  EXPECT_EQ(run.next(), kSpare);
  EXPECT_EQ(run.actions.back().kind, Kind::kDone);
  EXPECT_FALSE(run.arbiter.awaits(run.step));
  run.runTo(20);
  EXPECT_EQ(run.arbiter.holder(), kSpare);
}

TEST(Failover, TheHoldersFailureEndsACommittedPlan) {
  ArbiterRun run;
  run.handOverUpTo(kSecond);
  run.fail(kFirst);
  EXPECT_EQ(run.next(), kSpare) << "the fallback, not the one the cancelled plan named";
  run.runTo(20);
  EXPECT_EQ(run.arbiter.holder(), kSpare);
  EXPECT_EQ(run.kinds(), (Kinds{Kind::kPrepare, Kind::kCommit, Kind::kCancel, Kind::kRefused, Kind::kDone}));
}

TEST(Failover, TheIncomingControllersFailureEndsThePlanAndTheHolderStays) {
  for (const bool committed : {false, true}) {
    ArbiterRun run;
    committed ? run.handOverUpTo(kSecond) : run.request(kSecond);
    run.fail(kSecond, "it crashed");
    EXPECT_EQ(run.actions[run.actions.size() - 2].kind, Kind::kCancel);
    EXPECT_EQ(run.actions.back().kind, Kind::kRefused);
    EXPECT_EQ(run.lastReason(), "it crashed");
    EXPECT_FALSE(run.arbiter.awaits(run.step));
    run.runTo(20);
    EXPECT_EQ(run.arbiter.holder(), kFirst);
    EXPECT_FALSE(run.arbiter.changedAt(kMargin + 1));
  }
}

TEST(Failover, AnOutgoingControllerThatFailsAtItsLastCommandIsNotAskedForIt) {
  ArbiterRun run;
  run.handOverUpTo(kSecond);
  run.next();
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kFirst);
  run.fail(kFirst);
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kBrake);
  EXPECT_EQ(run.next(), kSecond) << "the baton has passed already";
}

TEST(Failover, ANewHolderThatFailsAtItsFirstStepIsFollowedAtTheNext) {
  ArbiterRun run;
  run.handOverUpTo(kSecond);
  run.next();
  run.fail(kSecond);
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kFirst);
  EXPECT_EQ(run.next(), kSpare);
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kBrake);
}

TEST(Failover, NobodyIsPromisedTheBatonBetweenAFailureAndTheFallback) {
  // Whoever follows is known when the next step opens; a plan made now would name the wrong outgoing controller.
  ArbiterRun run;
  run.fail(kFirst);
  run.request(kSpare);
  EXPECT_EQ(run.actions.back().kind, Kind::kRefused);
  EXPECT_NE(run.lastReason().find("step 1 goes to a fallback"), std::string::npos) << run.lastReason();
  EXPECT_EQ(run.next(), kSpare);
  run.handOverUpTo(kSecond);
  EXPECT_EQ(run.lastPlan().outgoing, kSpare);
  EXPECT_EQ(run.next(), kSecond);
}

TEST(Failover, AFailureBeforeTheFirstStepIsDecidedThere) {
  BatonArbiter arbiter(fourControllers());
  arbiter.memberFailed(kFirst, 0, "it never started");
  EXPECT_EQ(arbiter.open(0), kSpare);
  const std::optional<ArbiterAction> action = arbiter.takeAction();
  ASSERT_TRUE(action);
  EXPECT_EQ(action->plan.decided_at_step, 0u);
  EXPECT_EQ(action->plan.at_step, 0u);
}

TEST(Failover, ACheckpointKnowsItsMembersByName) {
  ArbiterRun run;
  run.runTo(10);
  run.fail(kSecond);
  run.arbiter.memberJoined({"late"});
  std::array<std::byte, 1024> room{};
  StateArchive saved = StateArchive::into(room);
  run.arbiter.archive(saved);
  const auto bytes = std::span(std::as_const(room)).first(saved.size());

  ArbiterConfig other = fourControllers();
  other.members = {{"late"}, {"spare"}, {"second"}, {"force", true}, {"later"}, {"first"}};
  other.fallback = {};
  BatonArbiter restored(other);
  StateArchive archive = StateArchive::from(bytes);
  restored.archive(archive);
  EXPECT_TRUE(archive.isWhole());
  EXPECT_EQ(restored.holder(), 5) << "first";
  for (int member = 0; member < 6; ++member) EXPECT_EQ(restored.hasFailed(member), member == 2) << member;
  EXPECT_EQ(restored.failedAt(2), 10U);

  other.members.pop_back();
  other.holder = 0;
  BatonArbiter lacking(other);
  StateArchive refused = StateArchive::from(bytes);
  lacking.archive(refused);
  EXPECT_FALSE(refused.isGood()) << "it has no first";
}

}  // namespace
}  // namespace baton::test
