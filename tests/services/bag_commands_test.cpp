// What `baton bag` says and makes of recordings that begin with samples from before.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bag/subcommands.hpp"
#include "dds/types.hpp"
#include "mcap/reader.hpp"
#include "mcap/repeated.hpp"
#include "mcap/writer.hpp"

namespace baton {
namespace {

using Json = nlohmann::json;

class BagCommands : public testing::Test {
 protected:
  BagCommands() {
    std::string name = (std::filesystem::temp_directory_path() / "baton-bag-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder = name;
    addBagCut(bag, exit_code);
    addBagInfo(bag, exit_code);
    addBagMerge(bag, exit_code);
  }
  ~BagCommands() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  struct Sample {
    std::string topic;
    std::uint32_t sequence;
    std::uint64_t time_ns;
    std::uint64_t publish_time_ns;
  };
  /// @param repeated  how many of the first are from before.
  std::string write(const std::string& name, const std::vector<Sample>& samples, std::uint64_t repeated) const {
    mcap::Writer writer(folder / name);
    writer.addMetadata("baton.run", {{"run", "r"}});
    if (repeated > 0) writer.addMetadata(mcap::kRepeatedRecord, mcap::repeatedRecord(repeated));
    std::map<std::string, mcap::ChannelId> channels;
    for (const Sample& one : samples) {
      dds::Guid guid;
      guid.bytes.fill(static_cast<std::uint8_t>(one.topic.front()));
      auto& channel = channels[one.topic];
      if (channel == mcap::ChannelId{}) {
        channel = writer.addChannel(one.topic, "cdr", mcap::kNoSchema, {{"writer", dds::toString(guid)}});
      }
      writer.write(channel, one.sequence, one.time_ns, one.publish_time_ns, {});
    }
    writer.close();
    return (folder / name).string();
  }
  void parse(std::vector<std::string> words) {
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    bag.parse(words);
  }
  Json run(std::vector<std::string> words) {
    words.emplace_back("--json");
    testing::internal::CaptureStdout();
    parse(words);
    return Json::parse(testing::internal::GetCapturedStdout());
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder / name).string(); }

  std::filesystem::path folder;
  CLI::App bag;
  ExitCode exit_code = ExitCode::kOk;
};

TEST_F(BagCommands, CutCountsWhatWasRecordedAndNotWhatIsRepeated) {
  const std::string in = write("a.mcap", {{"e", 1, 10, 1}, {"e", 2, 10, 2}, {"e", 3, 10, 10}, {"x", 1, 11, 11}}, 2);
  const Json cut = run({"cut", in, path("out.mcap"), "--topics", "e"});
  EXPECT_EQ(cut.at("messages"), 1);
  EXPECT_EQ(cut.at("latched"), 2);
  EXPECT_EQ(cut.at("left_out"), 1) << "x";
}

TEST_F(BagCommands, TheFileToMakeComesLast) {
  const std::string a = write("a.mcap", {{"e", 1, 10, 10}}, 0);
  const std::uintmax_t size = std::filesystem::file_size(a);
  EXPECT_THROW(parse({"merge", a, "--overwrite"}), UsageError);
  EXPECT_THROW(parse({"merge", path("absent.mcap"), a, "--overwrite"}), UnavailableError);
  EXPECT_THROW(parse({"cut", a, "--overwrite"}), UsageError);
  EXPECT_THROW(parse({"cut", path("absent.mcap"), a, "--topics", "e", "--overwrite"}), UnavailableError);
  EXPECT_EQ(std::filesystem::file_size(a), size);
}

TEST_F(BagCommands, MergeHasEverythingThatAFileRepeatsOnce) {
  const std::string a = write("a.mcap", {{"e", 1, 10, 10}, {"x", 1, 12, 12}}, 0);
  const std::string c = write("c.mcap", {{"e", 1, 30, 10}, {"e", 2, 30, 20}, {"e", 3, 31, 31}}, 2);
  EXPECT_EQ(run({"merge", a, c, path("out.mcap")}).at("messages"), 4);
  std::vector<std::uint32_t> sequences;
  mcap::Reader(path("out.mcap")).forEachMessage({.topics = {"e"}}, [&](const mcap::MessageView& message) {
    sequences.push_back(message.sequence);
  });
  EXPECT_EQ(sequences, (std::vector<std::uint32_t>{1, 2, 3})) << "2 came while nothing was recorded";
}

TEST_F(BagCommands, InfoBlamesNoClockAndFindsNoGapForWhatIsRepeated) {
  std::vector<Sample> samples;
  for (std::uint32_t sequence = 1; sequence <= 1000; ++sequence) samples.push_back({"e", sequence, 2000, sequence});
  samples.push_back({"e", 1200, 3000, 3000});
  const std::string file = write("a.mcap", samples, 1000);
  const Json info = run({"info", file});
  EXPECT_EQ(info.at("messages"), 1001);
  EXPECT_EQ(info.at("clock"), Json::array());
  EXPECT_EQ(info.at("topics").at(0).at("gaps"), 0) << "what was before the beginning is no gap";
}

}  // namespace
}  // namespace baton
