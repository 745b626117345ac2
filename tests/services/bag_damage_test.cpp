// What `baton bag` says of recordings that are damaged, of parts that are missing, and of ranges with nothing in them.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bag/subcommands.hpp"
#include "mcap/reader.hpp"
#include "mcap/writer.hpp"
#include "support/processes.hpp"
#include "support/recorded_files.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using Words = std::vector<std::string>;

struct Outcome {
  ExitCode exit_code = ExitCode::kOk;
  std::string out{}, err{};
};

Outcome run(Words words) {
  CLI::App bag;
  Outcome outcome;
  addBagCat(bag, outcome.exit_code);
  addBagCut(bag, outcome.exit_code);
  addBagExport(bag, outcome.exit_code);
  addBagInfo(bag, outcome.exit_code);
  addBagMerge(bag, outcome.exit_code);
  addBagRecover(bag, outcome.exit_code);
  addBagVerify(bag, outcome.exit_code);
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  try {
    bag.parse(words);
  } catch (const Error& error) {
    outcome.exit_code = error.code();
    outcome.err = error.what();
  }
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err += testing::internal::GetCapturedStderr();
  return outcome;
}

class BagDamage : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (bench.folder() / name).string(); }

  /// Zeros from one byte up to the other.
  static void zero(const std::string& file, std::uint64_t from, std::uint64_t end) {
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekp(static_cast<std::streamoff>(from));
    bytes << std::string(static_cast<std::size_t>(end - from), '\0');
  }
  /// Where the record of a kind begins and ends, the n-th from 0 on.
  static std::pair<std::uint64_t, std::uint64_t> recordIn(const std::string& file, mcap::Opcode opcode, int n) {
    const mcap::InputFile input{fs::path(file)};
    mcap::RecordWalk walk(input, mcap::kMagic.size(), input.size());
    while (const auto place = walk.next()) {
      if (place->opcode == opcode && n-- == 0) return {place->offset, place->end()};
    }
    throw std::runtime_error("no such record");
  }

  test::Bench bench;
};

TEST_F(BagDamage, ZerosAreToldByEveryCommandWithPlaceAndSize) {
  const std::string file = test::writeRecording(bench.folder(), "run").front();
  const auto [from, end] = recordIn(file, mcap::Opcode::kChunk, 2);
  zero(file, from + mcap::kRecordHeadBytes, end);
  const std::string place = std::to_string(end - from) + " bytes at byte " + std::to_string(from);
  for (const char* command : {"info", "verify"}) {
    const Outcome found = run({command, file});
    EXPECT_EQ(found.exit_code, ExitCode::kUsage) << command;
    EXPECT_NE(found.out.find(place), std::string::npos) << found.out;
    EXPECT_NE(found.out.find("zero bytes"), std::string::npos) << found.out;
  }
  const Outcome cat = run({"cat", file});
  EXPECT_EQ(cat.exit_code, ExitCode::kFailed);
  EXPECT_NE(cat.err.find(place), std::string::npos) << cat.err;
  const Outcome recovered = run({"recover", file, path("sound.mcap"), "--json"});
  EXPECT_EQ(recovered.exit_code, ExitCode::kFailed);
  const Json left_out = Json::parse(recovered.out).at("left_out");
  EXPECT_EQ(left_out.at("size_B"), end - from);
  EXPECT_EQ(left_out.at("chunks"), 1);
  EXPECT_EQ(left_out.at("messages").get<int>() + Json::parse(recovered.out).at("messages").get<int>(), 603);
}

TEST_F(BagDamage, AnIndexThatPointsNowhereIsAFaultOfTheVerdict) {
  const std::string file = test::writeRecording(bench.folder(), "run").front();
  const auto [from, end] = recordIn(file, mcap::Opcode::kFooter, 0);
  zero(file, from + mcap::kRecordHeadBytes, end);  // as if there was no index
  const Outcome found = run({"verify", file});
  EXPECT_EQ(found.exit_code, ExitCode::kUsage) << found.out;
  EXPECT_NE(found.out.find("gives no summary, though"), std::string::npos) << found.out;
  EXPECT_NE(found.out.find("`bag recover`"), std::string::npos) << found.out;
  EXPECT_EQ(run({"recover", file, path("sound.mcap")}).exit_code, ExitCode::kOk);
  EXPECT_TRUE(mcap::Reader(path("sound.mcap")).info().has_summary);
}

TEST_F(BagDamage, PartsThatAreMissingOrUnreadableAreNamed) {
  const Words files = test::writeRecording(bench.folder(), "run", {.parts = 4});
  ASSERT_EQ(run({"verify", files[1], "--parts"}).exit_code, ExitCode::kOk);
  EXPECT_EQ(run({"merge", files[0], files[1], files[2], files[3], path("whole.mcap.out")}).exit_code, ExitCode::kOk);
  const Outcome merged = run({"merge", files[1], files[2], path("some.mcap.out")});
  EXPECT_EQ(merged.exit_code, ExitCode::kFailed);
  EXPECT_NE(merged.err.find("run_0003.mcap, in which it goes on, is missing"), std::string::npos) << merged.err;
  const Outcome rest = run({"merge", files[1], files[2], files[3], path("rest.mcap.out")});
  EXPECT_EQ(rest.exit_code, ExitCode::kFailed);
  EXPECT_NE(rest.err.find("part 0 is missing"), std::string::npos) << rest.err;
  zero(files[3], 0, 100);
  const Outcome found = run({"verify", files[0], "--parts"});
  EXPECT_EQ(found.exit_code, ExitCode::kUsage) << found.out;
  EXPECT_NE(found.out.find("a part cannot be read and is left out: " + files[3]), std::string::npos) << found.out;
  const Outcome info = run({"info", files[0], "--parts"});
  EXPECT_EQ(info.exit_code, ExitCode::kFailed) << info.out;
  EXPECT_NE(info.out.find("cannot be read and is left out"), std::string::npos) << info.out;
}

TEST_F(BagDamage, ARangeWithNothingInItIsRefused) {
  const std::string file = path("a.mcap");
  {
    mcap::Writer writer(file);
    const auto channel = writer.addChannel("t", "cdr", mcap::kNoSchema);
    for (const std::uint64_t time_s : {0, 10}) writer.write(channel, 1, time_s * 1'000'000'000, 0, {});
    writer.close();
  }
  for (const Words& words : {Words{"cat", file}, Words{"export", file, "--json", "--out", path("tables")},
                             Words{"cut", file, path("out.mcap")}}) {
    for (const auto& [range, text] : {std::pair{Words{"--from", "2", "--to", "3"}, "expected messages in these"},
                                      {Words{"--from", "3", "--to", "2"}, "exchange the two"},
                                      {Words{"--from", "11"}, "; choose a part of that"}}) {
      Words all = words;
      all.insert(all.end(), range.begin(), range.end());
      const Outcome found = run(all);
      EXPECT_EQ(found.exit_code, ExitCode::kUsage) << words[0] << " " << range[1];
      EXPECT_NE(found.err.find(text), std::string::npos) << words[0] << ": " << found.err;
    }
  }
  EXPECT_FALSE(fs::exists(path("out.mcap")));
}

TEST_F(BagDamage, FilesOfOtherKindsAreNamedByEveryCommand) {
  for (const auto& [begin, hint] : {std::pair{"#ROSBAG V2.0\n", "ROS 1 bag: `mcap convert`"},
                                    {"SQLite format 3", "`ros2 bag convert`"},
                                    {"PK\x03\x04", "zip archive"},
                                    {"", "it is empty"},
                                    {"just text", "it is text"}}) {
    const std::string file = bench.write("other.mcap", begin);
    for (const Words& words :
         {Words{"cat", file}, Words{"info", file}, Words{"verify", file}, Words{"recover", file, path("out.mcap")},
          Words{"cut", file, path("out.mcap"), "--from", "0"}, Words{"merge", file, path("out.mcap")},
          Words{"export", file, "--csv", "--out", path("tables")}}) {
      const Outcome found = run(words);
      EXPECT_EQ(found.exit_code, ExitCode::kUsage) << words[0];
      EXPECT_NE(found.err.find(hint), std::string::npos) << words[0] << ": " << found.err;
    }
  }
}

}  // namespace
}  // namespace baton
