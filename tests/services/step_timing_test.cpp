/// What the plant tells of its punctuality, fed with a clock of the test's own.
#include "step_timing.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace baton {
namespace {

TEST(StepTiming, NothingRecordedReportsZeros) {
  const msg::TimingStatus status = StepTiming{}.report(3, 4);
  EXPECT_EQ(status.step(), 3U);
  EXPECT_EQ(status.missed_steps(), 4U);
  EXPECT_EQ(status.period().count(), 0U);
  EXPECT_EQ(status.period().max_us(), 0.0);
  EXPECT_EQ(status.jitter().count(), 0U);
  EXPECT_EQ(status.command_age().count(), 0U);
}

TEST(StepTiming, APeriodIsFromOneOpeningToTheNext) {
  StepTiming timing;
  std::int64_t now_ns = 77'000'000'000;
  timing.opened(now_ns, true);
  for (int step = 1; step <= 1000; ++step) timing.opened(now_ns += (step == 500 ? 900'000 : 100'000), true);
  const msg::TimeSpread period = timing.report(1000, 0).period();
  EXPECT_EQ(period.count(), 1000U);
  EXPECT_NEAR(period.p50_us(), 100.0, 1.0);
  EXPECT_NEAR(period.p999_us(), 100.0, 1.0);
  EXPECT_DOUBLE_EQ(period.max_us(), 900.0);
  EXPECT_DOUBLE_EQ(period.mean_us(), 100.8);
}

TEST(StepTiming, AStepThatAnOperatorHeldIsLeftOut) {
  StepTiming timing;
  timing.opened(0, true);
  timing.opened(100'000, true);  // the first period
  timing.interrupted();          // paused in the middle of the step
  timing.opened(60'000'000'000, true);
  timing.opened(60'000'200'000, false);  // the second; single steps: held from the start
  timing.opened(90'000'000'000, false);
  timing.opened(95'000'000'000, true);
  timing.opened(95'000'300'000, true);  // the third
  const msg::TimeSpread period = timing.report(6, 0).period();
  EXPECT_EQ(period.count(), 3U);
  EXPECT_DOUBLE_EQ(period.mean_us(), 200.0);
  EXPECT_DOUBLE_EQ(period.max_us(), 300.0);
}

TEST(StepTiming, ATorqueAgesUntilAFreshOneComes) {
  StepTiming timing;
  for (const bool is_old : {false, true, true, true, false, true}) timing.ticked(0, is_old);
  const msg::StepSpread age = timing.report(6, 4).command_age();  // 0 1 2 3 0 1
  EXPECT_EQ(age.count(), 6U);
  EXPECT_EQ(age.p50(), 1U);
  EXPECT_EQ(age.p99(), 3U);
  EXPECT_EQ(age.max(), 3U);
  EXPECT_DOUBLE_EQ(age.mean(), 7.0 / 6.0);
}

TEST(StepTiming, JitterIsTheLatenessOfTheTick) {
  StepTiming timing;
  for (const std::int64_t late_ns : {0, 50'000, 50'000, 250'000}) timing.ticked(late_ns, false);
  const msg::TimeSpread jitter = timing.report(4, 0).jitter();
  EXPECT_EQ(jitter.count(), 4U);
  EXPECT_NEAR(jitter.p50_us(), 50.0, 0.5);
  EXPECT_DOUBLE_EQ(jitter.max_us(), 250.0);
}

TEST(StepTiming, AHandoverTakesFromItsPlanToItsStep) {
  StepTiming timing;
  timing.opened(0, true);
  timing.planned(1, 1'000'000);
  timing.handedOver(1, 4'000'000);
  timing.handedOver(0, 5'000'000);  // a failover: nobody asked
  timing.planned(2, 6'000'000);     // comes to nothing
  timing.planned(3, 7'000'000);
  timing.handedOver(2, 8'000'000);
  timing.handedOver(3, 8'000'000);
  timing.planned(4, 9'000'000);
  timing.interrupted();  // an operator's pause is nobody's delay
  timing.handedOver(4, 99'000'000);
  timing.planned(5, 99'000'000);
  timing.handedOver(5, 100'000'000);
  const msg::TimingStatus status = timing.report(9, 0);
  EXPECT_EQ(status.handover().count(), 2u);
  EXPECT_EQ(status.handover().max_us(), 3000.0);
  EXPECT_EQ(status.last_handover_plan(), 3u);
  EXPECT_EQ(status.last_handover_us(), 1000.0);
}

}  // namespace
}  // namespace baton
