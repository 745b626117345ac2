/// The names of a recording that is split.
#include "runtime/recording_parts.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "base/error.hpp"
#include "mcap/reader.hpp"
#include "mcap/writer.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

TEST(RecordingParts, AreNumberedBesideTheFirst) {
  EXPECT_EQ(partOf("/data/run.mcap", 0), "/data/run.mcap");
  EXPECT_EQ(partOf("/data/run.mcap", 1), "/data/run_0001.mcap");
  EXPECT_EQ(partOf("/data/run.mcap", 12345), "/data/run_12345.mcap");
  EXPECT_EQ(partOf("run.mcap", 2), "run_0002.mcap");
  EXPECT_EQ(partOf("/data.d/run", 3), "/data.d/run_0003");
}

TEST(RecordingParts, AreFoundAmongOtherFiles) {
  std::string pattern = (fs::temp_directory_path() / "baton-parts-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const fs::path folder = pattern;
  for (const char* name :
       {"run.mcap", "run_0002.mcap", "run_0001.mcap", "run_10000.mcap", "run_1.mcap", "run_01000.mcap", "run_0003.txt",
        "run_abcd.mcap", "other_0001.mcap", "run_step12.mcap", "run_.mcap"}) {
    std::ofstream(folder / name) << "x";
  }
  EXPECT_EQ(furtherPartsOf(folder / "run.mcap"),
            (std::vector<fs::path>{folder / "run_0001.mcap", folder / "run_0002.mcap", folder / "run_10000.mcap"}));
  EXPECT_TRUE(furtherPartsOf(folder / "absent" / "run.mcap").empty());
  fs::remove_all(folder);
}

TEST(RecordingParts, AreKnownWithoutReadingThem) {
  std::string pattern = (fs::temp_directory_path() / "baton-parts-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const fs::path part = fs::path(pattern) / "run_0001.mcap";
  {
    mcap::Writer writer(part);
    writer.addMetadata("baton.part", {{"first", "run.mcap"}, {"index", "1"}});
    writer.write(writer.addChannel("t", "cdr", mcap::kNoSchema), 0, 0, 0, mcap::asBytes("data"));
    writer.close();
  }
  const std::uint64_t size = fs::file_size(part);
  std::vector<std::uint64_t> seen;
  mcap::setOpeningSink([&](const fs::path&, std::uint64_t done, std::uint64_t) { seen.push_back(done); });
  (void)claimRecording("--out", (fs::path(pattern) / "run.mcap").string(), true, true);
  mcap::setOpeningSink({});
  EXPECT_EQ(seen, std::vector<std::uint64_t>{size}) << "it was opened, and no chunk of it was read";
  EXPECT_FALSE(fs::exists(part));
  fs::remove_all(pattern);
}

TEST(RecordingParts, AreKnownThoughTheyAreDamaged) {
  std::string pattern = (fs::temp_directory_path() / "baton-parts-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const fs::path part = fs::path(pattern) / "run_0001.mcap";
  {
    mcap::Writer writer(part);
    writer.addMetadata("baton.part", {{"first", "run.mcap"}, {"index", "1"}});
    const mcap::ChannelId channel = writer.addChannel("t", "cdr", mcap::kNoSchema);
    for (int i = 0; i < 2; ++i) {
      writer.write(channel, 0, 0, 0, mcap::asBytes("data"));
      writer.addMetadata("between", {});  // ends the chunk
    }
    writer.close();
  }
  std::string bytes;
  {
    std::ifstream in(part, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  bytes.resize(bytes.size() - 40);  // no index
  const std::size_t between = bytes.find("between");
  ASSERT_NE(between, std::string::npos);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(between), 30, '\0');
  std::ofstream(part, std::ios::binary) << bytes;
  (void)claimRecording("--out", (fs::path(pattern) / "run.mcap").string(), true, true);
  EXPECT_FALSE(fs::exists(part));
  fs::remove_all(pattern);
}

TEST(RecordingParts, OfWhatIsReadAreNeverReplaced) {
  std::string pattern = (fs::temp_directory_path() / "baton-parts-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const fs::path folder = pattern, recording = folder / "run.mcap", part = folder / "run_0001.mcap";
  std::ofstream(recording) << "whole";
  {
    mcap::Writer writer(part);
    writer.addMetadata("baton.part", {{"first", "run.mcap"}, {"index", "1"}});
    writer.close();
  }
  fs::create_symlink(recording, folder / "by_link.mcap");
  fs::create_hard_link(recording, folder / "twin.mcap");
  const auto refusalOf = [&](const fs::path& out, bool is_split, const fs::path& read) -> std::string {
    try {
      (void)claimRecording("--out", out.string(), is_split, true, {folder / "not_there.yaml", read});
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* name : {"run.mcap", "by_link.mcap", "twin.mcap"}) {
    EXPECT_NE(refusalOf(folder / name, false, recording).find("is what is read here: choose another name"),
              std::string::npos)
        << name;
  }
  EXPECT_NE(refusalOf(recording, true, part).find("run_0001.mcap is what is read here"), std::string::npos);
  EXPECT_TRUE(fs::exists(recording));
  EXPECT_TRUE(fs::exists(part));
  EXPECT_EQ(refusalOf(recording, false, part), "") << "a part that is none of what is to be made stays";
  EXPECT_FALSE(fs::exists(recording));
  EXPECT_TRUE(fs::exists(part));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace baton
