#include "time/dry_runs.hpp"

#include <gtest/gtest.h>

#include "arbiter_run.hpp"

namespace baton::test {
namespace {

/// A question to `target` at the open step, and the answer once both sides of it are known, in either order.
class Asked {
 public:
  explicit Asked(ArbiterRun& run, const HandoverRequest& request) : runs(run.arbiter), step(run.step) {
    plan = runs.ask(request, step);
  }
  Verdict verdict() {
    const std::optional<DryRun> answered = runs.takeAnswered();
    EXPECT_TRUE(answered.has_value());
    return answered ? answered->verdict : Verdict{};
  }
  void forecast(double value) { runs.forecastArrived(7, kSecond, readyWith(efforts(value))); }
  void stepKnown(double holder) { runs.stepIsKnown(step, {.holder_effort = efforts(holder), .in_contact = false}); }

  DryRuns runs;
  std::uint64_t step;
  std::optional<HandoverPlan> plan;
};

constexpr HandoverRequest kToSecond{.request_id = 7, .target = kSecond};

TEST(DryRuns, AnswerOnceForecastAndStepAreKnownInEitherOrder) {
  ArbiterRun run;
  for (const bool forecast_first : {true, false}) {
    Asked asked(run, kToSecond);
    ASSERT_TRUE(asked.plan.has_value());
    EXPECT_EQ(asked.plan->forecast_step, run.step) << "the open step is compared";
    forecast_first ? asked.forecast(5.0) : asked.stepKnown(2.0);
    EXPECT_FALSE(asked.runs.takeAnswered().has_value());
    forecast_first ? asked.stepKnown(2.0) : asked.forecast(5.0);
    const Verdict verdict = asked.verdict();
    EXPECT_TRUE(verdict.isFeasible());
    EXPECT_EQ(verdict.effort_step, efforts(3.0));
    EXPECT_TRUE(asked.runs.isIdle());
  }
  EXPECT_TRUE(run.actions.empty()) << "the arbiter heard nothing of it";
  EXPECT_EQ(run.arbiter.planUnderWay(), nullptr);
}

TEST(DryRuns, GiveTheReasonThatAHandoverWouldBeRefusedWith) {
  ArbiterRun run;
  Asked far(run, kToSecond);
  far.forecast(2 * kLimit);
  far.stepKnown(0.0);
  const Verdict verdict = far.verdict();
  EXPECT_NE(std::string(verdict.objection.data()).find("above the limit"), std::string::npos);
  EXPECT_EQ(verdict.effort_step, efforts(2 * kLimit)) << "and how far it is";

  Asked itself(run, {.request_id = 7, .target = kFirst});
  EXPECT_FALSE(itself.plan.has_value()) << "nobody needs to be asked";
  EXPECT_NE(std::string(itself.verdict().objection.data()).find("holds the baton already"), std::string::npos);
}

TEST(DryRuns, DoNotWaitForWhoFailsOrSaysNothing) {
  ArbiterRun run;
  Asked failing(run, kToSecond);
  failing.runs.memberFailed(kSecond);
  EXPECT_FALSE(failing.verdict().isFeasible());

  Asked silent(run, kToSecond);
  silent.stepKnown(0.0);
  silent.runs.stepIsKnown(silent.step + 10'000, {.holder_effort = efforts(0.0), .in_contact = false});
  EXPECT_NE(std::string(silent.verdict().objection.data()).find("no forecast"), std::string::npos);

  Asked dropped(run, kToSecond);
  dropped.runs.dropAll("the run has ended");
  EXPECT_STREQ(dropped.verdict().objection.data(), "the run has ended");
}

TEST(DryRuns, TakeWordOfTheRightControllerAndQuestionAlone) {
  ArbiterRun run;
  Asked asked(run, kToSecond);
  asked.stepKnown(0.0);
  asked.runs.forecastArrived(8, kSecond, readyWith(efforts(1.0)));
  asked.runs.forecastArrived(7, kSpare, readyWith(efforts(1.0)));
  EXPECT_FALSE(asked.runs.takeAnswered().has_value());
  asked.forecast(1.0);
  asked.forecast(9.0);  // too late: the first word counts
  EXPECT_EQ(asked.verdict().effort_step, efforts(1.0));
}

TEST(DryRuns, HaveALimit) {
  ArbiterRun run;
  DryRuns runs(run.arbiter);
  int refused = 0;
  for (std::uint64_t id = 1; id <= 100; ++id)
    refused += runs.ask({.request_id = id, .target = kSecond}, run.step) ? 0 : 1;
  EXPECT_EQ(refused, 100 - 32);
}

}  // namespace
}  // namespace baton::test
