// The study of the coupling lets runs grow without bound on purpose: what a run does about too large commands must not
// make one that grows look as if it died out.
#include "report/coupling_charts.hpp"

#include <gtest/gtest.h>

#include "report/theory.hpp"
#include "support/checkout.hpp"

namespace baton::test {
namespace {

ChartResult studied(const std::string& scenario, ChartResult (*study)(const study::Inputs&)) {
  Trace base;
  base.scenario = loadScenario((deployFolder() / "scenarios/cosim" / (scenario + ".yaml")).string());
  return study({{}, base, [](double) {}});
}

void expectAgreement(const ChartResult& result) {
  EXPECT_FALSE(result.checks.empty());
  for (const Check& check : result.checks) {
    EXPECT_TRUE(check.passes()) << check.what << ": predicted " << check.predicted << ", measured " << check.measured;
  }
}

TEST(CouplingStudy, RunsDieOutWhereTheEigenvaluesSaySo) {
  const ChartResult result = studied("damped_spring", study::couplingStability);
  expectAgreement(result);
  for (const ChartPanel& panel : result.chart.panels) {
    EXPECT_FALSE(panel.series.at(0).points.empty()) << panel.title << ": none dies out";
    EXPECT_FALSE(panel.series.at(1).points.empty()) << panel.title << ": none grows";
  }
}

TEST(CouplingStudy, TheErrorHasItsOrder) {
  for (const char* scenario : {"arm_in_springs", "touch"}) {
    SCOPED_TRACE(scenario);
    expectAgreement(studied(scenario, study::couplingError));
  }
}

}  // namespace
}  // namespace baton::test
