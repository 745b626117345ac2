// A recording of a real run that was split, read as one by every command; and pieces of it, cut out by steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "mcap/joined_reader.hpp"
#include "msg/loop.h"
#include "runtime/recording_parts.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A run with its parts in a folder, and what `bag merge` makes of them.
class RecordingParts : public testing::Test {
 protected:
  void SetUp() override {
    record("parts", "{compression: none, chunk_kB: 32, split_MB: 0.4}");
    parts = {(folder / "run.mcap").string()};
    for (const fs::path& part : furtherPartsOf(folder / "run.mcap")) parts.push_back(part.string());
    ASSERT_GE(parts.size(), 3U);
    const Finished merged = bench.baton(Words{"bag", "merge"} + parts + Words{whole});
    ASSERT_EQ(merged.exit_code, 0) << merged.err;
  }
  void record(const std::string& name, const std::string& recording) const {
    fs::create_directory(bench.folder() / name);
    const Finished run =
        bench.baton({"run", bench.write(name + ".yaml", shortContact("recording: " + recording + "\n")), "--out",
                     (bench.folder() / name / "run.mcap").string()});
    ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (bench.folder() / name).string(); }
  [[nodiscard]] Words reversed() const { return {parts.rbegin(), parts.rend()}; }

  Bench bench;
  const fs::path folder = bench.folder() / "parts";
  const std::string whole = (bench.folder() / "whole.mcap").string();
  Words parts;
};

TEST_F(RecordingParts, EveryCommandReadsThemAsOne) {
  const auto expectSame = [&](const Words& command, const Words& recording, const Words& options) {
    const Finished one = bench.baton(command + Words{whole} + options),
                   other = bench.baton(command + recording + options);
    EXPECT_EQ(one.exit_code, 0) << command.back() << one.err;
    EXPECT_EQ(other.exit_code, 0) << command.back() << other.err;
    EXPECT_EQ(one.out, other.out) << command.back();
  };
  const Words cat{"bag", "cat"}, loop{"--topics", "plant_state,joint_command,event"};
  expectSame(cat, reversed(), loop);
  expectSame(cat, {folder.string()}, loop);
  expectSame(cat, {parts[1], "--parts"}, loop);
  expectSame(cat, reversed(), Words{"--from-step", "400", "--to-step", "600"} + loop);
  expectSame({"metrics"}, reversed(), {});
  expectSame({"shadow"}, reversed(), {});
  expectSame({"whatif"}, reversed(), {"--as", "impedance"});

  // Two recordings: a folder, or a part with its siblings, for each.
  EXPECT_EQ(bench.baton({"bag", "hash", folder.string(), whole}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "hash", "--parts", parts[2], whole}).exit_code, 0);
  const Finished diff = bench.baton({"bag", "diff", folder.string(), whole});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;

  EXPECT_EQ(bench.baton({"bag", "verify", folder.string()}).exit_code, 0);
  const nlohmann::json info = bench.batonJson(Words{"bag", "info", "--json"} + reversed());
  EXPECT_EQ(info.at("verdict"), "complete") << info;
  EXPECT_EQ(info.at("messages"), bench.batonJson({"bag", "info", "--json", whole}).at("messages"));

  const Words csv{"--csv", "--topics", "contact", "--out"};
  ASSERT_EQ(bench.baton(Words{"bag", "export"} + reversed() + csv + Words{path("a")}).exit_code, 0);
  ASSERT_EQ(bench.baton(Words{"bag", "export", whole} + csv + Words{path("b")}).exit_code, 0);
  EXPECT_EQ(contentOf(path("a/contact.csv")), contentOf(path("b/contact.csv")));

  const Finished rerun = bench.baton(Words{"rerun"} + reversed());
  EXPECT_EQ(rerun.exit_code, 0) << rerun.out << rerun.err;
  const Finished branch =
      bench.baton(Words{"branch"} + reversed() + Words{"--at", "500", "--out", path("branch.mcap")});
  EXPECT_EQ(branch.exit_code, 0) << branch.out << branch.err;
  EXPECT_TRUE(fs::exists(path("branch.mcap")));
  const nlohmann::json replay = bench.batonJson(Words{"replay"} + reversed() + Words{"--rate", "max", "--json"});
  EXPECT_EQ(replay.at("messages"), info.at("messages"));
}

TEST_F(RecordingParts, AMissingOneIsNamedAndAnotherRunIsRefused) {
  record("other", "{}");
  const Finished two = bench.baton({"bag", "cat", parts[0], path("other/run.mcap")});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_NE(two.err.find("of different runs: run "), std::string::npos) << two.err;
  EXPECT_TRUE(two.out.empty());

  fs::remove(parts[1]);
  const std::string hole = "part 1 is missing between " + parts[0] + " and " + parts[2];
  const Words few{"--topics", "contact"};
  const std::vector<Words> commands{Words{"bag", "cat", folder.string()} + few,
                                    Words{"bag", "export", folder.string(), "--json", "--out", path("out")} + few,
                                    Words{"bag", "cut", folder.string(), path("cut.mcap")} + few,
                                    Words{"bag", "info", folder.string()},
                                    Words{"bag", "hash", folder.string()},
                                    Words{"bag", "diff", folder.string(), whole},
                                    Words{"replay", folder.string(), "--rate", "max"} + few};
  for (const Words& command : commands) {
    const Finished finished = bench.baton(command);
    EXPECT_EQ(finished.exit_code, 1) << command[1] << finished.out << finished.err;
    EXPECT_NE((finished.out + finished.err).find(hole), std::string::npos)
        << command[1] << finished.out << finished.err;
  }
  const Finished hash = bench.baton({"bag", "hash", folder.string()});
  EXPECT_NE(hash.out.find(" are missing: what was before does not give the hash after them"), std::string::npos)
      << hash.out;
  EXPECT_EQ(bench.baton({"bag", "verify", folder.string()}).exit_code, 1);
}

TEST_F(RecordingParts, AreRecoveredEachUnderItsName) {
  {
    std::fstream part(parts[1], std::ios::in | std::ios::out | std::ios::binary);
    part.seekp(100'000);  // within a chunk
    part << std::string(1000, '?');
  }
  const Finished recovered = bench.baton({"bag", "recover", folder.string(), path("sound"), "--json"});
  EXPECT_EQ(recovered.exit_code, 1) << recovered.out << recovered.err;
  const nlohmann::json each = nlohmann::json::parse(recovered.out);
  ASSERT_EQ(each.size(), parts.size());
  for (const nlohmann::json& one : each) EXPECT_EQ(one.at("whole"), one.at("file") != parts[1]) << one;
  EXPECT_EQ(bench.batonJson({"bag", "info", path("sound"), "--json"}).at("verdict"), "complete");
  EXPECT_EQ(bench.baton({"bag", "recover", "--parts", parts[2], path("sound")}).exit_code, 3) << "they are there";
  EXPECT_EQ(bench.baton({"bag", "recover", "--parts", parts[2], path("sound"), "--overwrite"}).exit_code, 1);
  EXPECT_EQ(bench.baton({"bag", "recover", folder.string(), parts[0], "--overwrite"}).exit_code, 2) << "no folder";
}

TEST_F(RecordingParts, APieceBySteps) {
  const std::string piece = path("piece.mcap");
  const nlohmann::json cut = bench.batonJson(Words{"bag", "cut"} + reversed() +
                                             Words{piece, "--from-step", "500", "--to-step", "600", "--json"});
  std::vector<std::uint64_t> steps;
  for (const auto& state : decodeStream<msg::PlantState>(readStreams(piece)[{"plant_state", "plant"}])) {
    steps.push_back(state.step());
  }
  ASSERT_EQ(steps.size(), 101U);
  EXPECT_EQ(steps.front(), 500U);
  EXPECT_EQ(steps.back(), 600U);
  const Finished hash = bench.baton({"bag", "hash", piece, whole});
  EXPECT_EQ(hash.exit_code, 0) << hash.out;
  EXPECT_NE(hash.out.find("in the 101 steps that both have"), std::string::npos) << hash.out;

  // It begins with what a late joiner would have been given, and claims nothing by it.
  const std::uint64_t latched = cut.at("latched");
  EXPECT_EQ(mcap::JoinedReader(piece).repeated().count(), latched);
  EXPECT_GT(latched, 0U);
  EXPECT_TRUE(readStreams(piece).contains({"parameter_status", "tracking"}));
  const Finished verified = bench.baton({"bag", "verify", piece});
  EXPECT_EQ(verified.exit_code, 1) << verified.out;
  EXPECT_EQ(verified.out.find("twice"), std::string::npos) << verified.out;
  const nlohmann::json bare = bench.batonJson(
      {"bag", "cut", whole, path("bare.mcap"), "--from-step", "500", "--to-step", "600", "--no-latched", "--json"});
  EXPECT_EQ(bare.at("latched"), 0);
  EXPECT_EQ(bare.at("messages"), cut.at("messages"));

  // A replay begins with the same; simulated time says the same as steps.
  const Words replay{"replay", whole, "--rate", "max", "--json", "--from-sim", "0.25", "--to-sim", "0.3"};
  const std::uint64_t messages = cut.at("messages");
  EXPECT_EQ(bench.batonJson(replay).at("messages"), messages + latched);
  EXPECT_EQ(bench.batonJson(replay + Words{"--no-latched"}).at("messages"), messages);
  const Words by_step{"replay", whole, "--rate", "max", "--json", "--from-step", "500", "--to-step", "600"};
  EXPECT_EQ(bench.batonJson(by_step).at("messages"), messages + latched);
  const nlohmann::json by_time =
      bench.batonJson({"bag", "cut", whole, path("by_time.mcap"), "--from-sim", "0.25", "--to-sim", "0.3", "--json"});
  EXPECT_EQ(by_time.at("messages"), messages);
  EXPECT_EQ(bench.baton({"bag", "diff", piece, path("by_time.mcap")}).exit_code, 0);
  ASSERT_EQ(bench
                .baton({"bag", "export", whole, "--csv", "--topics", "plant_state", "--from-step", "500", "--to-step",
                        "600", "--out", path("exported")})
                .exit_code,
            0);
  const std::string rows = contentOf(path("exported/plant_state.csv"));
  EXPECT_EQ(std::ranges::count(rows, '\n'), 102) << "a head and 101 steps";

  const Finished beyond = bench.baton({"bag", "cut", whole, path("none.mcap"), "--from-step", "5000"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_NE(beyond.err.find("are 0 to 100"), std::string::npos) << beyond.err;
  EXPECT_FALSE(fs::exists(path("none.mcap")));
}

}  // namespace
}  // namespace baton::test
