// The loop in one process against the distributed system: the same bytes, step by step.
#include <gtest/gtest.h>

#include "runtime/paths.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

/// A deployed scenario as a file of its own, with one text replaced by another.
std::string variant(const Bench& bench, const std::string& scenario, const std::string& from, const std::string& to) {
  std::string text = readFile(deployFolder() / "scenarios" / (scenario + ".yaml"));
  const std::string robots = (deployFolder() / "robots").string() + "/";
  for (const auto& [what, with] : {std::pair<std::string, std::string>{"../../robots/", robots}, {from, to}}) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), with);
  }
  return bench.write("variant.yaml", text);
}

void expectSameBytes(const Bench& bench, const std::string& scenario) {
  const nlohmann::json distributed = bench.batonJson({"run", scenario, "--no-recording", "--json"});
  const nlohmann::json alone = bench.batonJson({"run", scenario, "--in-process", "--json"});
  ASSERT_EQ(distributed.at("state"), "finished") << distributed;
  ASSERT_EQ(alone.at("state"), "finished") << alone;
  for (const char* key : {"scenario", "exit_code", "reason", "step_ns", "steps", "sim_time_s", "chain_hash"}) {
    EXPECT_EQ(alone.at(key), distributed.at(key)) << key;
  }
  EXPECT_GT(alone.at("elapsed_s"), 0.0);
  EXPECT_EQ(alone.at("timing").at("period_us").at("count"), alone.at("steps"));
}

TEST(InProcess, AForceLawInContactHasTheSameBytes) {
  const Bench bench;
  // The path meets the wall at 1.56 s.
  expectSameBytes(bench, variant(bench, "report/fig44_admittance", "duration_s: 8", "duration_s: 2.5"));
}

TEST(InProcess, ALawWithoutForceHasTheSameBytes) {
  const Bench bench;
  expectSameBytes(bench, variant(bench, "report/fig09_inverse_dynamics", "duration_s: 8", "duration_s: 1"));
}

TEST(InProcess, AnotherRobotHasTheSameBytes) {
  const Bench bench;
  expectSameBytes(bench, "link1");
}

TEST(InProcess, EveryCouplingHasTheSameBytes) {
  const Bench bench;
  for (const char* scenario : {"cosim/spring_held", "cosim/spring_late", "cosim/touch"}) {
    SCOPED_TRACE(scenario);
    expectSameBytes(bench, scenario);
  }
}

TEST(InProcess, ACommandAboveTheLimitHasTheSameBytes) {
  const Bench bench;
  for (const char* fallback : {"[]", "[stiff]"}) {
    SCOPED_TRACE(fallback);
    expectSameBytes(bench, bench.write("too_much.yaml", "name: too_much\nrobot: " +
                                                            (deployFolder() / "robots/rpp.yaml").string() + R"(
step_s: 0.0005
substeps: 2
duration_s: 0.5
start: {position: [0.52, 0.2, 0.1]}
environment:
  walls: [{point_m: [0, 0, 0.7], normal: [0, 0, 1], stiffness_N_per_m: 200}]
trajectory:
  waypoints: [{time_s: 0, position: [pi/6, 0.2, 0.1]}]
controllers:
  - {name: soft, law: impedance}
  - {name: stiff, law: operational_inverse_dynamics}
active: soft
changes: [{at_s: 0.1, controller: soft, set: {kp: 1.0e+7}}]
baton: {max_command: 1000, fallback: )" + fallback + "}\n"));
  }
}

TEST(InProcess, SaysWhatItCannotDo) {
  const Bench bench;
  const auto expectRefusal = [&](const std::vector<std::string>& arguments, const std::string& word) {
    const Finished refused = bench.baton(arguments);
    EXPECT_EQ(refused.exit_code, 2) << refused.out;
    EXPECT_NE(refused.err.find(word), std::string::npos) << refused.err;
  };
  expectRefusal({"run", "demo", "--in-process"}, "swaps");
  expectRefusal({"run", "lab", "--in-process"}, "duration_s");
  expectRefusal({"run", "link1", "--in-process", "--out", "x.mcap"}, "--out");
  // Told to a person, it has no logs and no recording to name.
  const Finished told = bench.baton({"run", "cosim/damped_spring", "--in-process"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.out.find("steps       100, 3 s of motion"), std::string::npos) << told.out;
  EXPECT_EQ(told.out.find("logs"), std::string::npos) << told.out;
}

}  // namespace
}  // namespace baton::test
