/// A step is computed once, when all its inputs are here, in whatever order they came.
#include "time/step_inputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "support/robots.hpp"

namespace baton {
namespace {

struct Arrival {
  std::size_t input;
  std::uint64_t step;
};

/// A service as the loop has them: keeps values at slot(step), asks before it overwrites one, computes a complete step.
class Answerer {
 public:
  explicit Answerer(std::size_t inputs) : inputs_(inputs), rule_(inputs) {}

  void take(const Arrival& arrival) {
    const std::size_t slot = StepInputs::slot(arrival.step);
    const bool wanted = rule_.wants(arrival.input, arrival.step);
    if (wanted) values_[arrival.input][slot] = arrival.step;
    const bool complete = rule_.offer(arrival.input, arrival.step);
    EXPECT_TRUE(wanted || !complete);
    if (!complete) return;
    for (std::size_t i = 0; i < inputs_; ++i) EXPECT_EQ(values_[i][slot], arrival.step) << "input " << i;
    rule_.done(arrival.step);
    computed.push_back(arrival.step);
  }

  std::vector<std::uint64_t> computed;

 private:
  std::size_t inputs_;
  StepInputs rule_;
  std::uint64_t values_[StepInputs::kMaxInputs][StepInputs::kWindow] = {};
};

/// The same rule with unlimited memory.
std::vector<std::uint64_t> computedWithUnlimitedMemory(std::size_t inputs, const std::vector<Arrival>& arrivals) {
  std::map<std::uint64_t, std::set<std::size_t>> here;
  std::vector<std::uint64_t> computed;
  for (const Arrival& arrival : arrivals) {
    const bool is_new = here[arrival.step].insert(arrival.input).second;
    const bool is_over = !computed.empty() && arrival.step <= computed.back();
    if (is_new && !is_over && here[arrival.step].size() == inputs) computed.push_back(arrival.step);
  }
  return computed;
}

std::vector<std::uint64_t> steps(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> result;
  for (std::uint64_t step = first; step <= last; ++step) result.push_back(step);
  return result;
}

TEST(StepInputs, OrderOfArrivalDoesNotMatter) {
  std::vector<std::size_t> order{0, 1, 2};
  do {
    Answerer answerer(3);
    for (std::uint64_t step = 0; step < 10; ++step) {
      for (const std::size_t input : order) {
        EXPECT_EQ(answerer.computed.size(), step);
        answerer.take({input, step});
      }
      EXPECT_EQ(answerer.computed.size(), step + 1);
    }
    EXPECT_EQ(answerer.computed, steps(0, 9));
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(StepInputs, OneInputIsEnoughForAServiceThatNeedsOne) {
  Answerer answerer(1);
  for (std::uint64_t step = 0; step < 10; ++step) answerer.take({0, step});
  EXPECT_EQ(answerer.computed, steps(0, 9));
}

TEST(StepInputs, TheReferenceComesAStepEarly) {
  constexpr std::size_t kState = 0, kReference = 1;
  Answerer answerer(2);
  answerer.take({kReference, 0});
  for (std::uint64_t step = 0; step < 10; ++step) {
    answerer.take({kReference, step + 1});
    EXPECT_EQ(answerer.computed.size(), step);
    answerer.take({kState, step});
    EXPECT_EQ(answerer.computed.size(), step + 1);
  }
}

TEST(StepInputs, RemembersWhatWasComputedLast) {
  StepInputs inputs(1);
  EXPECT_FALSE(inputs.lastDone());
  EXPECT_TRUE(inputs.offer(0, 0));
  inputs.done(0);
  EXPECT_EQ(inputs.lastDone(), 0u);
}

TEST(StepInputs, DuplicatesAreNotWanted) {
  StepInputs inputs(2);
  EXPECT_FALSE(inputs.offer(0, 5));
  EXPECT_FALSE(inputs.wants(0, 5));
  EXPECT_FALSE(inputs.offer(0, 5));
  EXPECT_TRUE(inputs.offer(1, 5));
  EXPECT_FALSE(inputs.offer(1, 5)) << "complete once only, even before done() is called";
  inputs.done(5);
  EXPECT_FALSE(inputs.offer(0, 5));
  EXPECT_FALSE(inputs.offer(1, 5));
}

TEST(StepInputs, StepsAlreadyPassedAreNotWanted) {
  StepInputs inputs(2);
  inputs.done(7);
  for (std::uint64_t step = 0; step <= 7; ++step) {
    EXPECT_FALSE(inputs.wants(0, step));
    EXPECT_FALSE(inputs.offer(0, step));
    EXPECT_FALSE(inputs.offer(1, step));
  }
  EXPECT_TRUE(inputs.wants(0, 8));
}

TEST(StepInputs, AnOlderSampleNeverOverwritesANewerOne) {
  StepInputs inputs(2);
  EXPECT_FALSE(inputs.offer(0, 2 + StepInputs::kWindow));  // same slot as step 2
  EXPECT_FALSE(inputs.wants(0, 2));
  EXPECT_FALSE(inputs.offer(0, 2));
  EXPECT_FALSE(inputs.offer(1, 2)) << "step 2 has lost its other input";
  EXPECT_TRUE(inputs.offer(1, 2 + StepInputs::kWindow)) << "the newer one is untouched";
}

TEST(StepInputs, ASampleFromTheFarFutureCostsNoMoreThanTheStepsInItsSlot) {
  constexpr std::uint64_t kFar = 4'000'000'000'000'000'001;
  Answerer answerer(2);
  answerer.take({0, kFar});
  for (std::uint64_t step = 0; step < 20; ++step) {
    answerer.take({0, step});
    answerer.take({1, step});
  }
  for (std::uint64_t step = 0; step < 20; ++step) {
    const bool is_computed =
        std::find(answerer.computed.begin(), answerer.computed.end(), step) != answerer.computed.end();
    EXPECT_EQ(is_computed, StepInputs::slot(step) != StepInputs::slot(kFar)) << step;
  }
}

TEST(StepInputs, StepsThatNeverCompleteAreSkipped) {
  // Realtime: the plant does not wait, so whole steps may pass this service by.
  Answerer answerer(2);
  for (const std::uint64_t step : {0, 1, 2, 9, 10, 11, 500, 501}) {
    answerer.take({0, step});
    if (step != 10) answerer.take({1, step});
  }
  EXPECT_EQ(answerer.computed, (std::vector<std::uint64_t>{0, 1, 2, 9, 11, 500, 501}));
}

TEST(StepInputs, AStepOvertakenByALaterOneIsNotComputedAfterwards) {
  Answerer answerer(2);
  answerer.take({0, 3});
  answerer.take({0, 4});
  answerer.take({1, 4});
  answerer.take({1, 3});
  EXPECT_EQ(answerer.computed, (std::vector<std::uint64_t>{4}));
}

/// Samples of many steps, each delayed by less than three steps, some lost, some sent again at any later time. Within
/// that delay a window of four steps forgets nothing that may still be needed.
std::vector<Arrival> shuffledArrivals(std::mt19937& generator, std::size_t inputs, std::uint64_t count, double loss) {
  std::vector<std::pair<double, Arrival>> due;
  for (std::uint64_t step = 0; step < count; ++step) {
    for (std::size_t input = 0; input < inputs; ++input) {
      if (test::uniform(generator, 0.0, 1.0) < loss) continue;
      const double time = static_cast<double>(step) + test::uniform(generator, 0.0, 2.999);
      due.push_back({time, {input, step}});
      while (test::uniform(generator, 0.0, 1.0) < 0.3) {
        due.push_back({time + test::uniform(generator, 0.0, 30.0), {input, step}});
      }
    }
  }
  std::stable_sort(due.begin(), due.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Arrival> arrivals;
  arrivals.reserve(due.size());
  for (const auto& [time, arrival] : due) arrivals.push_back(arrival);
  return arrivals;
}

TEST(StepInputs, AgreesWithUnlimitedMemoryOnAnyInterleaving) {
  constexpr std::uint64_t kSteps = 200;
  std::mt19937 generator(20);
  for (int round = 0; round < 200; ++round) {
    const std::size_t inputs = 1 + static_cast<std::size_t>(round) % StepInputs::kMaxInputs;
    const double loss = round % 2 == 0 ? 0.0 : 0.1;
    const std::vector<Arrival> arrivals = shuffledArrivals(generator, inputs, kSteps, loss);
    Answerer answerer(inputs);
    for (const Arrival& arrival : arrivals) answerer.take(arrival);
    ASSERT_EQ(answerer.computed, computedWithUnlimitedMemory(inputs, arrivals)) << "round " << round;
    ASSERT_TRUE(std::is_sorted(answerer.computed.begin(), answerer.computed.end()));
  }
}

TEST(StepInputs, InLockstepEveryStepIsComputedExactlyOnce) {
  // The plant opens k + 1 when k has been answered: only the reference runs ahead. Order, and repetition, are free.
  std::mt19937 generator(21);
  for (int round = 0; round < 50; ++round) {
    Answerer answerer(3);
    answerer.take({1, 0});
    for (std::uint64_t step = 0; step < 300; ++step) {
      std::vector<Arrival> news{{0, step}, {1, step + 1}, {2, step}, {1, step}, {0, step > 0 ? step - 1 : 0}};
      std::shuffle(news.begin(), news.end(), generator);
      for (const Arrival& arrival : news) answerer.take(arrival);
      ASSERT_EQ(answerer.computed.size(), step + 1);
    }
    ASSERT_EQ(answerer.computed, steps(0, 299));
  }
}

}  // namespace
}  // namespace baton
