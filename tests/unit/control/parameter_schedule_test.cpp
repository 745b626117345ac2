/// Which parameters are in force when, told by the efforts of the laws that are made with them.
#include "control/parameter_schedule.hpp"

#include <gtest/gtest.h>

#include <array>

#include "base/error.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using Changes = std::vector<ParameterChange>;

ParameterChange change(std::uint64_t at_step, ParameterValues set) { return {at_step, std::move(set), false}; }

class Schedule : public ::testing::Test {
 protected:
  ParameterSchedule of(Changes planned = {}, const std::string& law_name = "joint_pd",
                       const ParameterValues& start = {}) {
    const LawInfo& law = findLaw(law_name);
    return {law, model, completeParameters(law.parameters, start, model.size()), std::move(planned)};
  }
  /// Everything at once, as when nothing happens meanwhile.
  static std::optional<ParameterChange> take(ParameterSchedule& schedule, const ParameterChange& asked,
                                             std::uint64_t next_step) {
    ParameterSchedule::Draft draft = schedule.draft(asked, next_step);
    schedule.make(draft);
    return schedule.accept(draft, next_step);
  }
  static double kp(const ParameterSchedule& schedule) { return number(schedule.values(), "kp"); }
  static double kd(const ParameterSchedule& schedule) { return number(schedule.values(), "kd"); }
  /// Of the law itself, which need not be the one that the values speak of.
  double effort(ParameterSchedule& schedule) const {
    LawInput input{.dt_s = 0.001, .state = {}, .contact = {}, .reference = {}};
    const JointVector zero = JointVector::Zero(model.size());
    input.state.q = input.state.qd = input.state.tau_applied = zero;
    input.reference.q = JointVector::Constant(model.size(), 0.1);
    input.reference.qd = input.reference.qdd = zero;
    JointVector tau = zero;
    EXPECT_EQ(schedule.law().step(input, tau), LawStatus::kOk);
    return tau(0);
  }
  /// Saved by one schedule, restored by another.
  static bool hand(ParameterSchedule& from, ParameterSchedule& to, std::uint64_t first_step) {
    std::array<std::byte, 4096> room{};
    StateArchive saved = StateArchive::into(room);
    from.archive(saved, 0);
    StateArchive restored = StateArchive::from(std::span(room).first(saved.size()));
    to.archive(restored, first_step);
    return saved.isGood() && restored.isWhole();
  }

  const RobotModel model = test::rppRobot();
};

TEST_F(Schedule, TakesEachPlannedChangeAtItsStepAndKeepsTheRest) {
  // Given out of order; one for two steps' worth of changes.
  ParameterSchedule schedule = of({change(20, {{"kd", std::vector{7.0}}}), change(10, {{"kp", std::vector{50.0}}})},
                                  "joint_pd", {{"kp", std::vector{30.0}}, {"kd", std::vector{5.0}}});
  const double before = effort(schedule);
  EXPECT_FALSE(schedule.advance(9));
  EXPECT_EQ(kp(schedule), 30.0);
  EXPECT_TRUE(schedule.advance(10));
  EXPECT_EQ(kp(schedule), 50.0);
  EXPECT_EQ(kd(schedule), 5.0);
  EXPECT_NEAR(effort(schedule) - before, (50.0 - 30.0) * 0.1, 1e-12);
  EXPECT_FALSE(schedule.advance(11));
  EXPECT_TRUE(schedule.advance(25)) << "steps may be skipped";
  EXPECT_EQ(kp(schedule), 50.0);
  EXPECT_EQ(kd(schedule), 7.0);
}

TEST_F(Schedule, TakesInWhatIsAskedForAndSaysWhenItComes) {
  ParameterSchedule schedule = of();
  EXPECT_EQ(take(schedule, change(0, {{"kp", std::vector{50.0}}}), 5)->at_step, 5u);
  const auto taken = take(schedule, change(8, {{"kp", std::vector{60.0}}}), 5);
  EXPECT_EQ(taken->at_step, 8u);
  EXPECT_EQ(std::get<std::vector<double>>(taken->set.at("kp")).size(), 3u) << "whole, as it will be";
  schedule.advance(5);
  EXPECT_EQ(kp(schedule), 50.0);
  schedule.advance(8);
  EXPECT_EQ(kp(schedule), 60.0);
}

TEST_F(Schedule, MovesOnWhenTheStepHasGoneByMeanwhile) {
  ParameterSchedule schedule = of();
  ParameterSchedule::Draft draft = schedule.draft(change(8, {{"kp", std::vector{50.0}}}), 5);
  schedule.make(draft);
  EXPECT_EQ(schedule.accept(draft, 12)->at_step, 12u);
  schedule.advance(11);
  EXPECT_NE(kp(schedule), 50.0);
  schedule.advance(12);
  EXPECT_EQ(kp(schedule), 50.0);
}

TEST_F(Schedule, ComesBeforeWhatWaitsForLaterAndIsKeptByIt) {
  ParameterSchedule schedule = of({change(20, {{"kd", std::vector{7.0}}})});
  take(schedule, change(10, {{"kp", std::vector{50.0}}}), 5);
  schedule.advance(20);
  EXPECT_EQ(kp(schedule), 50.0);
  EXPECT_EQ(kd(schedule), 7.0);
}

TEST_F(Schedule, OfTwoForOneStepTheLaterOneWins) {
  ParameterSchedule schedule = of({change(10, {{"kp", std::vector{40.0}}})});
  take(schedule, change(10, {{"kp", std::vector{50.0}}}), 5);
  schedule.advance(10);
  EXPECT_EQ(kp(schedule), 50.0);
}

TEST_F(Schedule, IsDraftedAgainWhenTheOrderIsNoLongerTheSame) {
  ParameterSchedule schedule = of({change(10, {{"kp", std::vector{40.0}}})});
  const ParameterChange asked = change(0, {{"kp", std::vector{50.0}}});
  ParameterSchedule::Draft draft = schedule.draft(asked, 5);
  schedule.make(draft);
  EXPECT_FALSE(schedule.accept(draft, 10)) << "it would now be the later of the two";
  schedule.advance(10);
  EXPECT_FALSE(schedule.accept(draft, 11)) << "other values are in force than when it was drafted";
  EXPECT_EQ(take(schedule, asked, 11)->at_step, 11u);
  schedule.advance(11);
  EXPECT_EQ(kp(schedule), 50.0);
}

TEST_F(Schedule, RefusesAllOfAChangeWhenOneValueIsWrong) {
  ParameterSchedule schedule = of();
  const ParameterValues before = schedule.values();
  const auto refuses = [&](ParameterValues set) {
    EXPECT_THROW(take(schedule, change(0, std::move(set)), 5), UsageError);
  };
  refuses({{"kp", std::vector{50.0}}, {"kd", std::vector{-1.0}}});
  refuses({{"kp", std::vector{1.0, 2.0}}});
  refuses({{"kp", std::string("high")}});
  refuses({{"kq", std::vector{50.0}}});
  refuses({});
  EXPECT_FALSE(schedule.advance(100));
  EXPECT_EQ(schedule.values(), before);
}

TEST_F(Schedule, LetsOnlySoManyWait) {
  ParameterSchedule schedule = of();
  for (std::size_t i = 0; i < ParameterSchedule::kMaxWaiting; ++i) {
    EXPECT_TRUE(take(schedule, change(100 + i, {{"kp", std::vector{50.0}}}), 5));
  }
  EXPECT_THROW(take(schedule, change(0, {{"kp", std::vector{50.0}}}), 5), UsageError);
  schedule.advance(100);
  EXPECT_TRUE(take(schedule, change(0, {{"kp", std::vector{60.0}}}), 101));
}

TEST_F(Schedule, GivesTheNextLawWhatTheOneBeforeRemembers) {
  // The adaptive law learns: with another gain it goes on from what it has learnt, where a new one would know nothing.
  const auto learnt = [&](bool changes) {
    ParameterSchedule schedule =
        of(changes ? Changes{change(200, {{"kd", std::vector{20.0}}})} : Changes{}, "adaptive");
    double last = 0.0;
    for (std::uint64_t step = 0; step < 200; ++step) last = effort(schedule);
    EXPECT_EQ(schedule.advance(200), changes);
    std::array<std::byte, 4096> room{};
    StateArchive saved = StateArchive::into(room);
    schedule.law().archive(saved);
    EXPECT_NE(last, 0.0);
    return std::vector<std::byte>(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(saved.size()));
  };
  EXPECT_EQ(learnt(true), learnt(false));
}

TEST_F(Schedule, GoesBackToThePlanWhenTheRunBeginsAnew) {
  ParameterSchedule schedule = of({change(20, {{"kd", std::vector{7.0}}})});
  const double start = kp(schedule);
  take(schedule, change(0, {{"kp", std::vector{50.0}}}), 5);
  take(schedule, change(30, {{"kp", std::vector{60.0}}}), 5);
  schedule.advance(20);
  schedule.rewind();
  EXPECT_EQ(kp(schedule), start);
  EXPECT_FALSE(schedule.advance(19));
  schedule.advance(40);
  EXPECT_EQ(kp(schedule), start);
  EXPECT_EQ(kd(schedule), 7.0);
}

TEST_F(Schedule, IsTheSameBehindACheckpoint) {
  const Changes planned{change(10, {{"kd", std::vector{6.0}}}), change(20, {{"kd", std::vector{7.0}}})};
  ParameterSchedule original = of(planned);
  take(original, change(0, {{"kp", std::vector{50.0, 60.0, 70.0}}}), 5);
  take(original, change(30, {{"kp", std::vector{80.0}}}), 5);
  original.advance(15);
  ParameterSchedule branch = of(planned);
  ASSERT_TRUE(hand(original, branch, 15));
  for (const std::uint64_t step : {15u, 19u, 20u, 29u, 30u}) {
    original.advance(step);
    branch.advance(step);
    EXPECT_EQ(branch.values(), original.values()) << "step " << step;
    EXPECT_EQ(effort(branch), effort(original)) << "step " << step;
  }
  // Words, too.
  ParameterSchedule printed = of({change(1, {{"form", std::string("as_printed")}})}, "impedance");
  printed.advance(1);
  ParameterSchedule again = of({}, "impedance");
  ASSERT_TRUE(hand(printed, again, 2));
  EXPECT_EQ(choice(again.values(), "form"), "as_printed");
}

TEST_F(Schedule, ABranchWithAnotherValueInItsScenarioHasThat) {
  ParameterSchedule original = of();
  take(original, change(0, {{"kp", std::vector{50.0}}, {"kd", std::vector{6.0}}}), 5);
  original.advance(5);
  ParameterSchedule branch = of({}, "joint_pd", {{"kp", std::vector{33.0}}});
  ASSERT_TRUE(hand(original, branch, 6));
  EXPECT_EQ(kp(branch), 33.0);
  EXPECT_EQ(kd(branch), 6.0);
}

TEST_F(Schedule, WhatWasAskedForAndIsPlannedWhenRepeatedHappensOnce) {
  const std::vector<double> first(3, 50.0);
  const std::vector<double> second(3, 60.0);
  ParameterSchedule original = of();
  take(original, change(10, {{"kp", first}}), 5);
  ParameterSchedule again = of({change(10, {{"kp", first}}), change(10, {{"kp", second}})});
  ASSERT_TRUE(hand(original, again, 6));
  again.advance(10);
  EXPECT_EQ(kp(again), 60.0);
}

TEST_F(Schedule, RefusesACheckpointOfSomethingElse) {
  ParameterSchedule schedule = of();
  std::array<std::byte, 64> room{};
  room.fill(std::byte{0xff});
  StateArchive restored = StateArchive::from(room);
  schedule.archive(restored, 1);
  EXPECT_FALSE(restored.isGood());
}

TEST_F(Schedule, NeverAllocatesWhenAChangeComesIntoForce) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  for (const LawInfo& law : allLaws()) {
    ParameterSchedule schedule =
        of({change(1, {{law.parameters.front().name, law.parameters.front().default_numbers}})}, law.name);
    const test::AllocationGuard guard;
    EXPECT_TRUE(schedule.advance(1));
    EXPECT_EQ(guard.count(), 0u) << law.name;
  }
}

}  // namespace
}  // namespace baton
