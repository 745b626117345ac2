/// Promises of the arbiter that hold whatever the news: determinism, one outcome a request, never a failed holder.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <random>

#include "arbiter_run.hpp"
#include "support/allocation_guard.hpp"
#include "support/robots.hpp"
#include "time/baton_arbiter.hpp"

namespace baton::test {
namespace {

using News = std::function<void(ArbiterRun&)>;
using Script = std::map<std::uint64_t, std::vector<News>>;  // by the step that is open

News forecastOf(std::uint64_t plan, int member, double value) {
  return [=](ArbiterRun& run) { run.forecast(plan, member, value); };
}
News commitAckOf(std::uint64_t plan, int member) {
  return [=](ArbiterRun& run) { run.arbiter.commitAcknowledged(plan, member); };
}
News failureOf(int member) {
  return [=](ArbiterRun& run) { run.fail(member); };
}

/// Everything a run decided: actions and, step by step, who held.
struct Decisions {
  std::vector<ArbiterAction> actions;
  std::vector<int> holders;
};

/// Lives the script with the news of each step, and the moment its inputs are complete, in a random order. As the plant
/// does, decides after each piece of news once the inputs are complete.
Decisions live(Script script, bool in_contact, std::mt19937& generator) {
  ArbiterRun run;
  run.in_contact = in_contact;
  Decisions decisions;
  while (run.step < 40) {
    bool complete = false;
    std::vector<News>& news = script[run.step];
    news.push_back([&complete](ArbiterRun&) { complete = true; });
    std::shuffle(news.begin(), news.end(), generator);
    for (const News& one : news) {
      one(run);
      if (complete) run.consider();
    }
    EXPECT_FALSE(run.arbiter.awaits(run.step)) << "step " << run.step;
    decisions.holders.push_back(run.next());
  }
  decisions.actions = run.actions;
  return decisions;
}

void expectSame(const Decisions& a, const Decisions& b, bool reasons_too) {
  ASSERT_EQ(a.holders, b.holders);
  ASSERT_EQ(a.actions.size(), b.actions.size());
  for (std::size_t i = 0; i < a.actions.size(); ++i) {
    const HandoverPlan& p = a.actions[i].plan;
    const HandoverPlan& q = b.actions[i].plan;
    EXPECT_EQ(a.actions[i].kind, b.actions[i].kind) << i;
    EXPECT_EQ(std::tie(p.plan_id, p.request_id, p.outgoing, p.incoming, p.decided_at_step, p.forecast_step, p.at_step),
              std::tie(q.plan_id, q.request_id, q.outgoing, q.incoming, q.decided_at_step, q.forecast_step, q.at_step))
        << i;
    if (reasons_too) {
      EXPECT_STREQ(a.actions[i].reason.data(), b.actions[i].reason.data()) << i;
    }
  }
}

void expectIndependentOfOrder(const Script& script, std::size_t actions, bool reasons_too = true) {
  std::mt19937 generator(30);
  for (const bool in_contact : {false, true}) {
    const Decisions first = live(script, in_contact, generator);
    EXPECT_EQ(first.actions.size(), actions);
    for (int i = 0; i < 200; ++i) expectSame(live(script, in_contact, generator), first, reasons_too);
  }
}

const News kRequestSecond = [](ArbiterRun& run) { run.request(kSecond, 12); };  // forecast at 7

TEST(ArbiterDeterminism, AHandoverDoesNotDependOnTheOrderOfTheNewsOfAStep) {
  expectIndependentOfOrder(
      {{3, {kRequestSecond}},
       {7, {forecastOf(1, kSecond, 5.0), forecastOf(1, kSpare, 5e9), forecastOf(9, kSecond, 5e9), failureOf(kForce)}},
       {9, {commitAckOf(1, kSecond), commitAckOf(1, kFirst), commitAckOf(2, kSecond), commitAckOf(1, kSpare)}},
       {20, {failureOf(kSecond), failureOf(kSpare)}}},
      4);
}

TEST(ArbiterDeterminism, NorDoesARefusal) {
  expectIndependentOfOrder({{3, {kRequestSecond, failureOf(kSpare)}},
                            {6, {forecastOf(1, kSecond, 2 * kLimit), forecastOf(1, kForce, 0.0)}},
                            {7, {forecastOf(1, kForce, 0.0), forecastOf(2, kSecond, 0.0)}}},
                           3);
}

TEST(ArbiterDeterminism, NorDoWhoFollowsAndTheOutcomeWhenSeveralFailAtOnce) {
  // The reason given may name either of the two; what is decided may not differ.
  expectIndependentOfOrder({{3, {kRequestSecond}},
                            {7, {forecastOf(1, kSecond, 5.0)}},
                            {9, {commitAckOf(1, kSecond), commitAckOf(1, kFirst)}},
                            {10, {failureOf(kSecond), failureOf(kFirst), failureOf(kSpare)}}},
                           5, false);
}

/// A crowd that asks, answers and fails at random; the plant goes on whatever is missing, as in realtime.
class RandomLife {
 public:
  explicit RandomLife(unsigned seed) : generator_(seed) {}

  void liveOneStep() {
    run.in_contact = chance(0.5);
    if (chance(0.3)) ask();
    if (chance(0.02)) run.fail(static_cast<int>(generator_() % 6) - 1);
    answer();
    if (chance(0.5)) ask();
    const int holder_before = run.arbiter.holder();
    const int holder = run.next();
    EXPECT_EQ(run.arbiter.holder(), holder);
    EXPECT_FALSE(run.arbiter.hasFailed(holder));
    if (holder != holder_before) {
      EXPECT_TRUE(run.arbiter.changedAt(run.step));
    }
    if (run.arbiter.outgoingAt(run.step) != kBrake) {
      EXPECT_EQ(run.arbiter.outgoingAt(run.step), holder_before);
    }
  }

  ArbiterRun run;
  std::uint64_t requests = 0;

 private:
  bool chance(double probability) { return uniform(generator_, 0.0, 1.0) < probability; }

  void ask() {
    const std::uint64_t at_step = chance(0.5) ? 0 : run.step + generator_() % 20;
    run.request(static_cast<int>(generator_() % 6) - 1, at_step, chance(0.2), ++requests);
    if (chance(0.1)) run.arbiter.refuseUnknown(++requests, "nobody", run.step);
  }

  void answer() {
    // News of any plan there is or was, most often of the latest.
    const std::uint64_t plan = chance(0.9) ? latestPlan() : generator_() % (latestPlan() + 2);
    for (int member = kFirst; member <= kSpare; ++member) {
      const JointVector effort = chance(0.95) ? efforts(uniform(generator_, -60.0, 60.0)) : JointVector();
      if (chance(0.6)) {
        run.arbiter.prepareAcknowledged(plan, member, chance(0.95) ? readyWith(effort) : notReady("it says no"));
      }
      if (chance(0.3)) run.consider();
      if (chance(0.6)) run.arbiter.commitAcknowledged(plan, member);
    }
  }

  [[nodiscard]] std::uint64_t latestPlan() const {
    std::uint64_t latest = 0;
    for (const ArbiterAction& action : run.actions) latest = std::max(latest, action.plan.plan_id);
    return latest;
  }

  std::mt19937 generator_;
};

TEST(ArbiterProperty, EveryRequestHasExactlyOneOutcome) {
  std::size_t done = 0, refused = 0, failovers = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomLife life(seed);
    for (int i = 0; i < 150; ++i) life.liveOneStep();
    life.run.runTo(life.run.step + 40);  // what is under way ends
    std::map<std::uint64_t, int> outcomes;
    for (const ArbiterAction& action : life.run.actions) {
      if (action.kind != Kind::kDone && action.kind != Kind::kRefused) continue;
      if (action.plan.request_id == 0) {
        ++failovers;
        EXPECT_EQ(action.kind, Kind::kDone);
        continue;
      }
      ++outcomes[action.plan.request_id];
      ++(action.kind == Kind::kDone ? done : refused);
    }
    ASSERT_EQ(outcomes.size(), life.requests) << "seed " << seed;
    for (const auto& [request, count] : outcomes) ASSERT_EQ(count, 1) << "request " << request << ", seed " << seed;
  }
  // The crowd is lively enough to have seen all of it.
  EXPECT_GT(done, 300u);
  EXPECT_GT(refused, 300u);
  EXPECT_GT(failovers, 100u);
}

TEST(ArbiterProperty, PlansFollowTheProtocol) {
  for (unsigned seed = 1000; seed < 1200; ++seed) {
    RandomLife life(seed);
    for (int i = 0; i < 150; ++i) life.liveOneStep();
    std::uint64_t last_plan = 0;
    Kind phase = Kind::kRefused;  // of the last plan; refused and done are its ends
    for (const ArbiterAction& action : life.run.actions) {
      if (action.plan.plan_id == 0) continue;  // refused at once, or a failover
      if (action.kind == Kind::kPrepare) {
        ASSERT_TRUE(phase == Kind::kRefused || phase == Kind::kDone) << "one plan at a time";
        ASSERT_EQ(action.plan.plan_id, last_plan + 1);
        ASSERT_GE(action.plan.forecast_step, action.plan.decided_at_step + 1);
        ASSERT_EQ(action.plan.at_step, action.plan.forecast_step + kMargin);
        last_plan = action.plan.plan_id;
      } else {
        ASSERT_EQ(action.plan.plan_id, last_plan);
        const Kind expected_before = action.kind == Kind::kCommit    ? Kind::kPrepare
                                     : action.kind == Kind::kDone    ? Kind::kCommit
                                     : action.kind == Kind::kRefused ? Kind::kCancel
                                                                     : phase;
        ASSERT_EQ(phase, expected_before);
        if (action.kind == Kind::kCancel) {
          ASSERT_TRUE(phase == Kind::kPrepare || phase == Kind::kCommit);
        }
      }
      phase = action.kind;
    }
  }
}

TEST(ArbiterProperty, TheSameNewsLeadToTheSameLife) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::array<Decisions, 2> lives;
    for (Decisions& decisions : lives) {
      RandomLife life(seed);
      for (int i = 0; i < 100; ++i) {
        life.liveOneStep();
        decisions.holders.push_back(life.run.arbiter.holder());
      }
      decisions.actions = life.run.actions;
    }
    expectSame(lives[0], lives[1], true);
  }
}

TEST(ArbiterProperty, NothingAllocatesOnceItIsMade) {
  if (!AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  BatonArbiter arbiter(fourControllers());
  const JointVector effort = efforts(1.0);
  const AllocationGuard guard;
  arbiter.open(0);
  arbiter.request({.request_id = 1, .target = kSecond}, 0);
  arbiter.refuseUnknown(2, "nobody", 0);
  arbiter.open(1);
  arbiter.prepareAcknowledged(1, kSecond, readyWith(effort));
  arbiter.consider(1, effort, false);
  arbiter.commitAcknowledged(1, kSecond);
  for (std::uint64_t step = 2; step < 10; ++step) arbiter.open(step);
  arbiter.memberFailed(kSecond, 9, "gone");
  arbiter.open(10);
  while (arbiter.takeAction()) {
  }
  EXPECT_EQ(guard.count(), 0u);
  EXPECT_EQ(arbiter.holder(), kSpare);
}

}  // namespace
}  // namespace baton::test
