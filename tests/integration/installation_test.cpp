// An installation, made as a person makes one.
#include <gtest/gtest.h>

#include <set>

#include "support/processes.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

std::set<std::string> namesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

TEST(Installation, FindsProgramsAndDataWhereItWasMadeAndWhereItWasMovedTo) {
  const Bench bench;
  const fs::path made = bench.folder() / "made";
  const Finished install =
      runProgram(BATON_TEST_CMAKE, {"--install", BATON_TEST_BUILD, "--prefix", made.string()}, bench.folder());
  ASSERT_EQ(install.exit_code, 0) << install.out << install.err;
  EXPECT_EQ(namesIn(made / "bin"), std::set<std::string>{"baton"});
  EXPECT_TRUE(namesIn(made / "share/baton").contains("idl"));

  const fs::path moved = bench.folder() / "moved elsewhere";
  const std::string domain = std::to_string(bench.domain());
  for (const fs::path& prefix : {made, moved}) {
    if (prefix == moved) fs::rename(made, moved);
    const std::string recording = (bench.folder() / (prefix.filename().string() + ".mcap")).string();
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"model", "--robot", "rpp", "--q", "pi/3", "0.1", "0.1"},
          {"run", "link1", "--out", recording, "--domain", domain},
          {"replay", recording, "--to", "0.2", "--domain", domain}}) {
      const Finished finished = runProgram(prefix / "bin/baton", arguments, bench.folder());
      EXPECT_EQ(finished.exit_code, 0) << prefix << " " << arguments.front() << "\n" << finished.out << finished.err;
    }
  }

  // As people put it on their path.
  const fs::path link = bench.folder() / "baton";
  fs::create_symlink(moved / "bin/baton", link);
  EXPECT_EQ(runProgram(link, {"model", "--robot", "link1", "--q", "0"}, bench.folder()).exit_code, 0);
}

}  // namespace
}  // namespace baton::test
