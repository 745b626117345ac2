#include "time/fault.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace baton {
namespace {

std::vector<std::uint64_t> struckSteps(const Fault& fault, std::uint64_t end) {
  std::vector<std::uint64_t> steps;
  for (std::uint64_t step = 0; step < end; ++step) {
    if (strikes(fault, step)) steps.push_back(step);
  }
  return steps;
}

TEST(Fault, StrikesFromItsFirstStepUpToTheOneThatIsSpared) {
  Fault fault;
  fault.from_step = 3;
  fault.until_step = 6;
  EXPECT_EQ(struckSteps(fault, 20), (std::vector<std::uint64_t>{3, 4, 5}));
}

TEST(Fault, AProbabilityIsMetAndDependsOnSeedAndStepAlone) {
  constexpr std::uint64_t kSteps = 100'000;
  Fault fault;
  fault.until_step = kSteps;
  fault.probability = 0.2;
  const auto steps = struckSteps(fault, kSteps);
  const double sigma = std::sqrt(0.2 * 0.8 * kSteps);
  EXPECT_NEAR(static_cast<double>(steps.size()), 0.2 * kSteps, 5.0 * sigma);
  EXPECT_EQ(struckSteps(fault, kSteps), steps);
  // Neighbours do not hang together: after one that is struck the next is with the same probability.
  std::size_t pairs = 0;
  for (std::size_t i = 1; i < steps.size(); ++i) pairs += steps[i] == steps[i - 1] + 1 ? 1U : 0U;
  EXPECT_NEAR(static_cast<double>(pairs), 0.04 * kSteps, 5.0 * sigma);
  fault.seed = 1;
  EXPECT_NE(struckSteps(fault, kSteps), steps);
}

TEST(Fault, NoProbabilityNeverAndAFullOneAlwaysStrikes) {
  Fault fault;
  fault.from_step = 0;
  fault.until_step = 1000;
  EXPECT_EQ(struckSteps(fault, 1000).size(), 1000U);
  fault.probability = 0.0;
  EXPECT_TRUE(struckSteps(fault, 1000).empty());
}

}  // namespace
}  // namespace baton
