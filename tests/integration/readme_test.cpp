// The README's commands, run as they stand there, in their order.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "support/processes.hpp"

namespace baton::test {
namespace {

/// The lines of the first block that begins with `fence` after `heading`.
std::vector<std::string> block(const std::string& heading, const std::string& fence) {
  std::ifstream readme(deployFolder().parent_path() / "README.md");
  std::vector<std::string> lines;
  bool under_heading = false;
  bool inside = false;
  for (std::string line; std::getline(readme, line);) {
    if (line == heading) under_heading = true;
    if (inside && line == "```") return lines;
    if (inside) lines.push_back(line);
    if (under_heading && line == fence) inside = true;
  }
  return {};
}

/// Runs the lines as a person would type them, one after another. What is left in the background may take its time to
/// appear: the next line waits for it.
void runLines(const Bench& bench, const std::vector<std::string>& lines) {
  const std::string prefix = "deploy/baton ";
  const auto run = [&](const std::string& arguments) {
    return runProgram("/bin/sh",
                      {"-c", "cd '" + bench.folder().string() + "' && BATON_DOMAIN=" + std::to_string(bench.domain()) +
                                 " '" + (programFolder() / "baton").string() + "' " + arguments},
                      bench.folder());
  };
  for (const std::string& line : lines) {
    ASSERT_TRUE(line.starts_with(prefix)) << line;
    const Finished finished = run(line.substr(prefix.size()));
    EXPECT_EQ(finished.exit_code, 0) << line << "\n" << finished.out << finished.err;
    if (line.find(" & ") != std::string::npos) {
      ASSERT_TRUE(eventually([&] { return run("player status").exit_code == 0; })) << line;
    }
  }
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
}

TEST(Readme, TheDailyCommandsWorkInTheirOrder) {
  const std::vector<std::string> commands = block("## Every day", "```sh");
  ASSERT_GE(commands.size(), 16U);
  runLines(Bench(), commands);
}

TEST(Readme, TheCommandsForRecordingsWorkInTheirOrder) {
  const Bench bench;
  ASSERT_EQ(bench.baton({"run", "demo", "--out", (bench.folder() / "demo.mcap").string()}).exit_code, 0);
  const std::vector<std::string> commands = block("## Recordings", "```sh");
  ASSERT_GE(commands.size(), 15U);
  runLines(bench, commands);
}

TEST(Readme, TheScenarioRuns) {
  const Bench bench;
  std::string text;
  for (const std::string& line : block("## Writing a scenario", "```yaml")) text += line + "\n";
  const nlohmann::json result = bench.batonJson({"run", bench.write("mine.yaml", text), "--json"});
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  ASSERT_EQ(result.at("swaps").size(), 1U);
  EXPECT_TRUE(result.at("swaps").at(0).at("done"));
}

TEST(Readme, TheDemoShowsWhatItPromises) {
  const Bench bench;
  const Finished demo = bench.baton({"demo"});
  ASSERT_EQ(demo.exit_code, 0) << demo.out << demo.err;
  // Numbers that are the same on every machine.
  for (const char* line :
       {"steps       20000, 10 s of motion", "step   1000  tracking -> force: refused, force controls force",
        "step   2000  tracking -> impedance: torques 0.00015 apart", "step   8000  impedance -> force",
        "step  16001  force -> impedance", "2.500000      2.500000", "3.000000      3.000000", ", complete",
        "replaying the first 2 seconds"}) {
    EXPECT_NE(demo.out.find(line), std::string::npos) << line << "\n" << demo.out;
  }
}

}  // namespace
}  // namespace baton::test
