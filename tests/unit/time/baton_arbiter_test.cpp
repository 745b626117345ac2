/// The two-phase handover, step by step, and every way in which it is refused.
#include "time/baton_arbiter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "arbiter_run.hpp"

namespace baton::test {
namespace {

using Kinds = std::vector<Kind>;

void expectRefusedBeforeAPlan(const ArbiterRun& run, const std::string& words) {
  ASSERT_FALSE(run.actions.empty());
  EXPECT_EQ(run.actions.back().kind, Kind::kRefused);
  EXPECT_EQ(run.lastPlan().plan_id, 0u);
  EXPECT_NE(run.lastReason().find(words), std::string::npos) << run.lastReason();
}

void expectRefusedAfterAPlan(const ArbiterRun& run, const std::string& words) {
  ASSERT_GE(run.actions.size(), 2u);
  const ArbiterAction& cancel = run.actions[run.actions.size() - 2];
  EXPECT_EQ(cancel.kind, Kind::kCancel);
  EXPECT_EQ(run.actions.back().kind, Kind::kRefused);
  EXPECT_EQ(cancel.plan.plan_id, run.lastPlan().plan_id);
  EXPECT_GT(run.lastPlan().plan_id, 0u);
  EXPECT_NE(run.lastReason().find(words), std::string::npos) << run.lastReason();
}

TEST(BatonArbiter, HandsOverAtTheStepItNamed) {
  ArbiterRun run;
  run.runTo(10);
  run.request(kSecond, 0, false, 77);
  ASSERT_EQ(run.kinds(), Kinds{Kind::kPrepare});
  const HandoverPlan plan = run.lastPlan();
  EXPECT_EQ(plan.request_id, 77u);
  EXPECT_EQ(plan.plan_id, 1u);
  EXPECT_EQ(plan.outgoing, kFirst);
  EXPECT_EQ(plan.incoming, kSecond);
  EXPECT_EQ(plan.decided_at_step, 10u);
  EXPECT_EQ(plan.forecast_step, 11u);
  EXPECT_EQ(plan.at_step, 11u + kMargin);

  EXPECT_FALSE(run.arbiter.awaits(10)) << "nothing is due before the forecast step";
  run.runTo(11);
  run.consider();
  EXPECT_TRUE(run.arbiter.awaits(11));
  run.forecast(1, kSecond, 3.0);
  EXPECT_FALSE(run.arbiter.awaits(11));
  run.consider();
  EXPECT_EQ(run.kinds(), (Kinds{Kind::kPrepare, Kind::kCommit}));

  run.runTo(14);
  EXPECT_FALSE(run.arbiter.awaits(14));
  run.runTo(15);
  EXPECT_TRUE(run.arbiter.awaits(15)) << "the last step before K";
  run.commitAcknowledgedBy(kSecond);
  EXPECT_TRUE(run.arbiter.awaits(15)) << "the outgoing one must know of its last command";
  run.commitAcknowledgedBy(kFirst);
  EXPECT_FALSE(run.arbiter.awaits(15));

  EXPECT_EQ(run.arbiter.holder(), kFirst);
  EXPECT_EQ(run.next(), kSecond);
  ASSERT_EQ(run.step, plan.at_step);
  EXPECT_EQ(run.kinds(), (Kinds{Kind::kPrepare, Kind::kCommit, Kind::kDone}));
  EXPECT_EQ(run.lastPlan().request_id, 77u);
  EXPECT_EQ(run.lastReason(), "");
  for (std::uint64_t step = 0; step < 30; ++step) {
    EXPECT_EQ(run.arbiter.changedAt(step), step == plan.at_step) << step;
    EXPECT_EQ(run.arbiter.outgoingAt(step), step == plan.at_step ? kFirst : kBrake) << step;
  }
  EXPECT_EQ(run.next(), kSecond);
}

TEST(BatonArbiter, WaitsForAStepFarAway) {
  ArbiterRun run;
  run.request(kSecond, 500);
  EXPECT_EQ(run.lastPlan().forecast_step, 500 - kMargin);
  run.forecast(1, kSecond, 0.0);  // an early answer is kept
  run.runTo(500 - kMargin);
  EXPECT_EQ(run.kinds(), Kinds{Kind::kPrepare});
  run.consider();
  EXPECT_EQ(run.kinds(), (Kinds{Kind::kPrepare, Kind::kCommit}));
  run.commitAcknowledgedBy(kSecond);
  run.commitAcknowledgedBy(kFirst);
  run.runTo(499);
  EXPECT_EQ(run.arbiter.holder(), kFirst);
  EXPECT_EQ(run.next(), kSecond);
}

TEST(BatonArbiter, HandsOverAgainAndAgain) {
  ArbiterRun run;
  int holder = kFirst;
  for (const int target : {kSecond, kSpare, kFirst, kSecond}) {
    run.handOverUpTo(target);
    EXPECT_EQ(run.arbiter.holder(), holder);
    EXPECT_EQ(run.next(), target);
    EXPECT_EQ(run.arbiter.outgoingAt(run.step), holder);
    holder = target;
  }
  EXPECT_EQ(run.lastPlan().plan_id, 4u);
}

TEST(BatonArbiter, TheNextRequestDoesNotDisturbTheHandoverOfTheOpenStep) {
  ArbiterRun run;
  run.handOverUpTo(kSecond);
  run.next();
  run.request(kSpare);
  EXPECT_EQ(run.actions.back().kind, Kind::kPrepare);
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kFirst) << "its last command is still to come";
  EXPECT_TRUE(run.arbiter.changedAt(run.step));
}

TEST(BatonArbiter, TheBrakeHandsOverWithoutAcknowledging) {
  ArbiterConfig config = fourControllers();
  config.holder = kBrake;
  ArbiterRun run(config);
  run.request(kSecond);
  run.runTo(1);
  run.forecast(1, kSecond, 0.0);
  run.consider();
  run.commitAcknowledgedBy(kSecond);
  run.runTo(kMargin);
  EXPECT_FALSE(run.arbiter.awaits(kMargin));
  EXPECT_EQ(run.next(), kSecond);
  EXPECT_EQ(run.arbiter.outgoingAt(run.step), kBrake);
}

TEST(BatonArbiter, MarginOfOneIsEnough) {
  ArbiterConfig config = fourControllers();
  config.margin_steps = 1;
  ArbiterRun run(config);
  run.request(kSecond);
  EXPECT_EQ(run.lastPlan().forecast_step, 1u);
  EXPECT_EQ(run.lastPlan().at_step, 2u);
  run.runTo(1);
  EXPECT_TRUE(run.arbiter.awaits(1));
  run.forecast(1, kSecond, 0.0);
  run.consider();
  EXPECT_TRUE(run.arbiter.awaits(1)) << "committed at the last step before K";
  run.commitAcknowledgedBy(kSecond);
  run.commitAcknowledgedBy(kFirst);
  EXPECT_FALSE(run.arbiter.awaits(1));
  EXPECT_EQ(run.next(), kSecond);
}

TEST(BatonArbiter, AcknowledgementsOfOthersAndOfOtherPlansAreIgnored) {
  ArbiterRun run;
  run.request(kSecond);
  run.runTo(1);
  run.forecast(1, kSpare, 0.0);
  run.forecast(2, kSecond, 0.0);
  run.forecast(0, kSecond, 0.0);
  run.arbiter.commitAcknowledged(1, kSecond);  // nothing is committed yet
  EXPECT_TRUE(run.arbiter.awaits(1));
  run.forecast(1, kSecond, 0.0);
  run.consider();
  run.runTo(kMargin);
  run.arbiter.commitAcknowledged(2, kSecond);
  run.arbiter.commitAcknowledged(1, kSpare);
  run.arbiter.commitAcknowledged(1, kBrake);
  run.arbiter.prepareAcknowledged(1, kSecond, notReady("too late to refuse"));
  EXPECT_TRUE(run.arbiter.awaits(kMargin));
  run.next();
  expectRefusedAfterAPlan(run, "did not acknowledge the commit");
  EXPECT_EQ(run.arbiter.holder(), kFirst);
}

TEST(BatonArbiter, WithoutTheOutgoingAcknowledgementRealtimeHandsOverAllTheSame) {
  ArbiterRun run;
  run.request(kSecond);
  run.runTo(1);
  run.forecast(1, kSecond, 0.0);
  run.consider();
  run.commitAcknowledgedBy(kSecond);
  run.runTo(kMargin);
  EXPECT_TRUE(run.arbiter.awaits(kMargin)) << "lockstep would wait";
  EXPECT_EQ(run.next(), kSecond);
}

TEST(BatonArbiter, ActionsComeInTheOrderOfTheDecisions) {
  BatonArbiter arbiter(fourControllers());
  arbiter.open(0);
  arbiter.refuseUnknown(1, "nobody", 0);
  arbiter.request({.request_id = 2, .target = kSecond}, 0);
  arbiter.request({.request_id = 3, .target = kSpare}, 0);
  arbiter.memberFailed(kSecond, 0, "gone");
  const Kinds expected{Kind::kRefused, Kind::kPrepare, Kind::kRefused, Kind::kCancel, Kind::kRefused};
  const std::vector<std::uint64_t> requests{1, 2, 3, 2, 2};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::optional<ArbiterAction> action = arbiter.takeAction();
    ASSERT_TRUE(action);
    EXPECT_EQ(action->kind, expected[i]) << i;
    EXPECT_EQ(action->plan.request_id, requests[i]) << i;
  }
  EXPECT_FALSE(arbiter.takeAction());
}

TEST(BatonArbiter, RefusesWhomItDoesNotKnow) {
  ArbiterRun run;
  for (const int target : {-7, kBrake, 4, 1'000'000}) {
    run.request(target);
    expectRefusedBeforeAPlan(run, "no such controller");
  }
  run.arbiter.refuseUnknown(9, "joint_dp", 0);
  run.next();
  expectRefusedBeforeAPlan(run, "joint_dp");
  EXPECT_EQ(run.lastPlan().request_id, 9u);
}

TEST(BatonArbiter, RefusesTheHolder) {
  ArbiterRun run;
  run.request(kFirst);
  expectRefusedBeforeAPlan(run, "first holds the baton already");
}

TEST(BatonArbiter, RefusesAMemberThatFailed) {
  ArbiterRun run;
  run.fail(kSecond);
  run.request(kSecond);
  expectRefusedBeforeAPlan(run, "second has failed");
}

TEST(BatonArbiter, RefusesWhileAnotherHandoverIsUnderWay) {
  ArbiterRun run;
  run.request(kSecond);
  run.request(kSpare, 0, false, 2);
  expectRefusedBeforeAPlan(run, "a handover to second at step 6 is under way");
  EXPECT_EQ(run.lastPlan().request_id, 2u);
  run.runTo(1);
  run.forecast(1, kSecond, 0.0);
  run.consider();
  run.request(kSpare, 0, false, 3);
  expectRefusedBeforeAPlan(run, "is under way");
}

TEST(BatonArbiter, RefusesAStepThatIsTooNear) {
  ArbiterRun run;
  run.runTo(100);
  for (const std::uint64_t at_step : {1ull, 99ull, 100ull, 100ull + kMargin}) {
    run.request(kSecond, at_step);
    expectRefusedBeforeAPlan(run, "106 is the first possible");
  }
  run.request(kSecond, 101 + kMargin);
  EXPECT_EQ(run.actions.back().kind, Kind::kPrepare);
}

TEST(BatonArbiter, RefusesAStepTheRunDoesNotReach) {
  ArbiterConfig config = fourControllers();
  config.end_step = 50;
  ArbiterRun run(config);
  run.request(kSecond, 50);
  expectRefusedBeforeAPlan(run, "not before the end of the run at step 50");
  run.request(kSecond, 49);
  EXPECT_EQ(run.actions.back().kind, Kind::kPrepare);

  ArbiterRun late(config);
  late.runTo(49 - kMargin);
  late.request(kSecond);
  expectRefusedBeforeAPlan(late, "not before the end of the run");
}

TEST(BatonArbiter, AnEndThatIsBroughtForwardCancelsThePlanBehindIt) {
  for (const bool committed : {false, true}) {
    ArbiterRun run;
    run.request(kSecond, 20);
    if (committed) {
      run.forecast(1, kSecond, 0.0);
      run.runTo(20 - kMargin + 1);
      run.commitAcknowledgedBy(kSecond);
      run.commitAcknowledgedBy(kFirst);
      ASSERT_EQ(run.actions.back().kind, Kind::kCommit);
    }
    run.arbiter.endAt(21);
    run.drain();
    EXPECT_NE(run.actions.back().kind, Kind::kRefused) << "step 20 is still a step of the run";
    run.arbiter.endAt(20);
    run.drain();
    expectRefusedAfterAPlan(run, "the run ends before the handover");
    run.runTo(20);
    EXPECT_EQ(run.arbiter.holder(), kFirst);
    EXPECT_FALSE(run.arbiter.changedAt(20));
  }
}

/// A request to `target` with this forecast, up to the decision.
ArbiterRun decided(int target, const Forecast& forecast, bool force = false, bool in_contact = false) {
  ArbiterRun run;
  run.in_contact = in_contact;
  run.request(target, 0, force);
  run.runTo(1);
  run.arbiter.prepareAcknowledged(1, target, forecast);
  run.consider();
  return run;
}

TEST(BatonArbiter, RefusesWhoIsNotReady) {
  expectRefusedAfterAPlan(decided(kSecond, notReady("it is cold"), true), "is not ready: it is cold");
}

TEST(BatonArbiter, RefusesAForecastAboveTheLimitUnlessForced) {
  JointVector effort = efforts(0.0);
  effort(1) = -kLimit;
  EXPECT_EQ(decided(kSecond, readyWith(effort)).actions.back().kind, Kind::kCommit) << "the limit itself is allowed";
  effort(1) = std::nextafter(-kLimit, -100.0);
  expectRefusedAfterAPlan(decided(kSecond, readyWith(effort)), "joint 2");
  EXPECT_EQ(decided(kSecond, readyWith(effort), true).actions.back().kind, Kind::kCommit);
}

TEST(BatonArbiter, ComparesTheForecastWithTheHoldersEffortOfTheSameStep) {
  ArbiterRun run;
  run.request(kSecond);
  run.runTo(1);
  run.effort = efforts(1'000.0);
  run.forecast(1, kSecond, 1'000.0 - kLimit);
  run.consider();
  EXPECT_EQ(run.actions.back().kind, Kind::kCommit);
}

TEST(BatonArbiter, RefusesAForceLawOutOfContactEvenIfForced) {
  expectRefusedAfterAPlan(decided(kForce, readyWith(efforts(0.0)), true, false), "touches nothing");
  EXPECT_EQ(decided(kForce, readyWith(efforts(0.0)), false, true).actions.back().kind, Kind::kCommit);
}

TEST(BatonArbiter, RefusesAForecastThatIsNoEffortEvenIfForced) {
  expectRefusedAfterAPlan(decided(kSecond, readyWith(JointVector::Zero(2)), true), "2 efforts");
  expectRefusedAfterAPlan(decided(kSecond, readyWith(JointVector()), true), "0 efforts");
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    JointVector effort = efforts(0.0);
    effort(2) = bad;
    expectRefusedAfterAPlan(decided(kSecond, readyWith(effort), true), "not 3 finite ones");
  }
}

TEST(BatonArbiter, ThePlanCarriesBlendHardnessAndTheForecastDifference) {
  ArbiterConfig config = fourControllers();
  config.blend_steps = 200;
  const auto plan = [&](const HandoverRequest& request) {
    ArbiterRun run(config);
    run.arbiter.request(request, 0);
    run.runTo(1);
    run.effort = efforts(2.0);
    run.forecast(1, kSecond, 5.0);
    run.consider();
    EXPECT_EQ(run.actions.back().kind, Kind::kCommit);
    return run.lastPlan();
  };
  EXPECT_EQ(plan({.target = kSecond}).blend_steps, 200u);
  EXPECT_EQ(plan({.target = kSecond, .blend_steps = 30}).blend_steps, 30u);
  EXPECT_EQ(plan({.target = kSecond, .blend_steps = 0}).blend_steps, 0u);
  const HandoverPlan hard = plan({.target = kSecond, .hard = true, .blend_steps = 30});
  EXPECT_EQ(hard.blend_steps, 0u);
  EXPECT_TRUE(hard.hard);
  EXPECT_EQ(hard.forecast_effort_step, efforts(3.0));
  ArbiterRun failed(config);
  failed.fail(kFirst);
  failed.next();
  EXPECT_EQ(failed.lastPlan().blend_steps, 200u) << "a failover blends as the scenario says";
}

TEST(BatonArbiter, RefusesAForecastThatNeverCame) {
  ArbiterRun run;
  run.request(kSecond);
  run.runTo(2);  // realtime: nobody waited at step 1
  run.consider();
  expectRefusedAfterAPlan(run, "gave no forecast for step 1");
}

TEST(BatonArbiter, RefusesAForecastThatCameAfterItsStep) {
  ArbiterRun run;
  run.request(kSecond);
  run.runTo(2);
  run.forecast(1, kSecond, 0.0);
  run.consider();
  expectRefusedAfterAPlan(run, "too late");
}

TEST(BatonArbiter, AfterARefusalTheWayIsFree) {
  ArbiterRun run = decided(kSecond, readyWith(efforts(2 * kLimit)));
  EXPECT_FALSE(run.arbiter.awaits(run.step));
  run.forecast(1, kSecond, 0.0);  // a late word on the cancelled plan
  run.arbiter.commitAcknowledged(1, kSecond);
  run.handOverUpTo(kSpare);
  EXPECT_EQ(run.lastPlan().plan_id, 2u);
  EXPECT_EQ(run.next(), kSpare);
}

TEST(BatonArbiter, LongNamesAndReasonsAreCutNotOverrun) {
  const std::string longest(1'000, 'x');
  ArbiterConfig config = fourControllers();
  config.members[kSecond].name = longest;
  ArbiterRun run(config);
  run.request(kSecond);
  run.request(kSpare);
  EXPECT_LT(run.lastReason().size(), ReasonText{}.size());
  run.arbiter.prepareAcknowledged(1, kSecond, notReady(longest.c_str()));
  run.runTo(2);
  EXPECT_LT(run.lastReason().size(), ReasonText{}.size());
  run.fail(kFirst, longest.c_str());
  run.next();
  EXPECT_LT(run.lastReason().size(), ReasonText{}.size());
  EXPECT_NE(run.lastReason().find("at step 2"), std::string::npos);
}

}  // namespace
}  // namespace baton::test
