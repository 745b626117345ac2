// A run whose wall clock is set while it lasts, in every process of it again and again.
#include <gtest/gtest.h>

#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

TEST(WallClock, OfARunMayBeSetWithoutATraceInItsRecording) {
  const Bench bench;
  const std::string file = (bench.folder() / "set.mcap").string();
  // In the pace of the simulation, so that it lasts longer than from one time of setting to the next.
  const std::string scenario = bench.write("run.yaml", shortContact("rate: 1\n"));
  const Finished run =
      runProgram("/bin/sh",
                 {"-c", "LD_PRELOAD=" BATON_TEST_JUMPING_CLOCK " exec " + (programFolder() / "baton").string() +
                            " run " + scenario + " --out " + file + " --domain " + std::to_string(bench.domain())},
                 bench.folder());
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const Finished verified = bench.baton({"bag", "verify", file, "--json"});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  EXPECT_EQ(nlohmann::json::parse(verified.out).at("clock").size(), 0U) << verified.out;
}

}  // namespace
}  // namespace baton::test
