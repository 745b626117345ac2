// A disk that fills up while a run is recorded: a small file system of the test's own. The run goes on to its end and
// says what happened, and what was written until then can be read.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "mcap/repeated.hpp"
#include "msg/loop.h"
#include "runtime/recording_parts.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A file system in memory that only this process and those it starts see: none is left behind, however the test ends.
class SmallDisk {
 public:
  SmallDisk(fs::path folder, int kilobytes) : folder_(std::move(folder)) {
    fs::create_directories(folder_);
    static const bool is_alone =
        ::unshare(CLONE_NEWNS) == 0 && ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
    const std::string size = "size=" + std::to_string(kilobytes) + "k";
    is_mounted_ = is_alone && ::mount("none", folder_.c_str(), "tmpfs", 0, size.c_str()) == 0;
    if (!is_mounted_) problem_ = "cannot mount a file system: " + std::generic_category().message(errno);
  }
  ~SmallDisk() {
    if (is_mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  /// Why there is none; empty when there is one.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const fs::path& folder() const { return folder_; }
  [[nodiscard]] std::uint64_t freeBytes() const { return fs::space(folder_).available; }

 private:
  fs::path folder_;
  bool is_mounted_ = false;
  std::string problem_;
};

std::string scenario(const std::string& recording) {
  return shortContact("recording: {compression: none, " + recording + "}\n");  // 1.9 MB, were there room for it
}

class FullDisk : public testing::Test {
 protected:
  void SetUp() override {
    if (!disk_.problem().empty()) GTEST_SKIP() << disk_.problem();
  }

  /// A whole run, recorded onto the disk. Whatever becomes of the recording, it goes on to its end.
  void record(const std::string& recording) {
    result_ =
        bench_.batonJson({"run", bench_.write("short.yaml", scenario(recording)), "--out", file_.string(), "--json"});
    EXPECT_EQ(result_.at("state"), "finished") << result_;
    EXPECT_EQ(result_.at("steps"), kShortSteps);
    files_.clear();
    if (fs::exists(file_)) files_.push_back(file_);
    for (const fs::path& part : furtherPartsOf(file_)) files_.push_back(part);
    ASSERT_FALSE(files_.empty());
  }
  [[nodiscard]] std::string summary() const { return result_.at("recording").at("summary"); }
  [[nodiscard]] std::string recorderLog() const { return bench_.baton({"logs", "recorder"}).out; }

  /// The verdict over all files: 0 complete, 1 incomplete; 2, damaged, is none of a disk that was full.
  void expectVerified(int exit_code) const {
    std::vector<std::string> arguments{"bag", "verify"};
    for (const fs::path& file : files_) arguments.push_back(file.string());
    const Finished verified = bench_.baton(arguments);
    EXPECT_EQ(verified.exit_code, exit_code) << verified.out << verified.err;
  }
  /// All messages that are in the files, and in what `bag recover` makes of them; the states are whole from `first` on.
  void expectReadable(std::uint64_t first) {
    std::uint64_t messages = 0, next = first;
    for (const fs::path& file : files_) {
      const fs::path sound = bench_.folder() / "sound.mcap";
      const Finished recovered = bench_.baton({"bag", "recover", file.string(), sound.string(), "--overwrite"});
      EXPECT_LE(recovered.exit_code, 1) << recovered.out << recovered.err;  // 1: what is lost is the end
      EXPECT_EQ(mcap::Reader(sound).statistics().message_count, mcap::Reader(file).statistics().message_count);
      EXPECT_LE(bench_.baton({"bag", "verify", sound.string()}).exit_code, 1);
      messages += mcap::Reader(sound).statistics().message_count - mcap::Repeated(mcap::Reader(file)).count();
      for (const auto& state : decodeStream<msg::PlantState>(readStreams(sound.string())[{"plant_state", "plant"}])) {
        EXPECT_EQ(state.step(), next++);
      }
    }
    EXPECT_GT(next, first);
    if (first == 0) {
      EXPECT_EQ(result_.at("recording").at("messages"), messages) << "what is in the files, not what came";
    }
  }

  Bench bench_;
  SmallDisk disk_{bench_.folder() / "disk", 1000};
  fs::path file_ = disk_.folder() / "run.mcap";
  std::vector<fs::path> files_;
  Json result_;
};

TEST_F(FullDisk, WithoutAReserveTheFileEndsWhereTheDiskIsFull) {
  for (const char* chunks : {"chunk_kB: 256", "chunk_kB: 32", "chunk_kB: 32, max_MB: 100"}) {
    SCOPED_TRACE(chunks);
    fs::remove(file_);
    record(std::string("min_free_MB: 0, ") + chunks);
    EXPECT_EQ(result_.at("exit_code"), 1) << result_;
    EXPECT_EQ(result_.at("recording").at("complete"), false);
    EXPECT_NE(summary().find("No space left on device"), std::string::npos) << summary();
    EXPECT_NE(recorderLog().find("the run goes on"), std::string::npos) << recorderLog();
    EXPECT_EQ(disk_.freeBytes(), 0U);
    expectVerified(1);
    expectReadable(0);
  }
}

TEST_F(FullDisk, WithoutAReserveThePartsBeforeTheLastAreWhole) {
  record("min_free_MB: 0, chunk_kB: 32, split_MB: 0.2");
  EXPECT_EQ(result_.at("exit_code"), 1) << result_;
  EXPECT_GE(files_.size(), 3U);
  for (const fs::path& file : files_) {
    EXPECT_EQ(mcap::Reader(file).info().is_complete, file != files_.back()) << file;
  }
  expectVerified(1);
  expectReadable(0);
}

TEST_F(FullDisk, NoStubIsLeftOfAPartForWhoseBeginningThereIsNoRoom) {
  // Where the disk ends within a part is a matter of bytes: some of these end at the beginning of one.
  for (int kilobytes = 0; kilobytes < 16; kilobytes += 8) {
    SCOPED_TRACE(kilobytes);
    for (const fs::path& file : files_) fs::remove(file);
    std::ofstream(disk_.folder() / "ballast") << std::string(static_cast<std::size_t>(kilobytes) << 10, 'x');
    record("min_free_MB: 0, chunk_kB: 4, split_MB: 0.004, topics: [plant_state]");
    EXPECT_EQ(result_.at("exit_code"), 1) << result_;
    expectVerified(1);
    expectReadable(0);
  }
}

TEST_F(FullDisk, WithAReserveTheRecordingEndsInOrderAndTheReserveIsLeft) {
  for (const char* limit : {"min_free_MB: 0.3", "min_free_MB: 0.1, chunk_kB: 256", "min_free_MB: 0.3, max_MB: 100"}) {
    SCOPED_TRACE(limit);
    fs::remove(file_);
    record(std::string(limit) + ", when_full: stop");
    EXPECT_EQ(result_.at("exit_code"), 1) << result_;
    EXPECT_NE(summary().find("min_free_MB"), std::string::npos) << summary();
    EXPECT_GE(disk_.freeBytes(), std::string(limit).find("0.1") != std::string::npos ? 100'000U : 300'000U);
    EXPECT_NE(recorderLog().find("the recording ends at step"), std::string::npos) << recorderLog();
    EXPECT_TRUE(mcap::Reader(file_).info().is_complete) << "finished, with its index";
    expectVerified(1);
    expectReadable(0);
  }
}

TEST_F(FullDisk, ABudgetBelowTheDisksSizeNeverFillsIt) {
  record("min_free_MB: 0, chunk_kB: 32, max_MB: 0.8, when_full: stop");
  EXPECT_EQ(result_.at("exit_code"), 1) << result_;
  EXPECT_NE(summary().find("max_MB"), std::string::npos) << summary();
  EXPECT_GT(disk_.freeBytes(), 0U);
  expectVerified(1);
  expectReadable(0);
}

TEST_F(FullDisk, TheOldestPartsMakeRoomWhereTheDiskRunsLow) {
  for (const char* limit : {"min_free_MB: 0.3", "min_free_MB: 0.3, max_MB: 100"}) {
    SCOPED_TRACE(limit);
    for (const fs::path& file : files_) fs::remove(file);
    record(std::string(limit) + ", chunk_kB: 32, split_MB: 0.15, when_full: drop_oldest");
    EXPECT_EQ(result_.at("exit_code"), 0) << result_;
    EXPECT_NE(summary().find("the oldest parts made room"), std::string::npos) << summary();
    EXPECT_NE(files_.front(), file_) << "the first part is gone";
    EXPECT_GE(disk_.freeBytes(), 300'000U);
    expectVerified(0);
    const auto states = decodeStream<msg::PlantState>(readStreams(files_.front().string())[{"plant_state", "plant"}]);
    ASSERT_FALSE(states.empty());
    expectReadable(states.front().step());
  }
}

TEST_F(FullDisk, ARingThatFindsNoRoomAtTheEndKeepsWhatThereWasRoomFor) {
  record("min_free_MB: 0, chunk_kB: 32, ring_s: 5");
  EXPECT_EQ(result_.at("exit_code"), 1) << result_;
  EXPECT_NE(summary().find("No space left on device"), std::string::npos) << summary();
  expectVerified(1);
  expectReadable(0);
}

TEST_F(FullDisk, WhereSomebodyMakesRoomTheRecorderCanBeginAnew) {
  const std::string text = endlessContact("recording: {compression: none, min_free_MB: 0}\n");
  const Finished up = bench_.baton({"up", bench_.write("live.yaml", text), "--out", file_.string()});
  ASSERT_EQ(up.exit_code, 0) << up.out << up.err;
  const auto status = [&] { return bench_.batonJson({"record", "status", "--json"}); };
  EXPECT_TRUE(eventually([&] { return status().at("state") == "failed"; }));
  EXPECT_NE(status().at("text").get<std::string>().find("No space left on device"), std::string::npos) << status();
  const fs::path second = disk_.folder() / "second.mcap";
  const Finished refused = bench_.baton({"record", "start", "--out", second.string()});
  EXPECT_EQ(refused.exit_code, 1) << refused.out << refused.err;
  EXPECT_FALSE(fs::exists(second)) << "there was no room for its beginning";
  fs::remove(file_);
  const Finished started = bench_.baton({"record", "start", "--out", second.string()});
  EXPECT_EQ(started.exit_code, 0) << started.out << started.err;
  const Finished down = bench_.baton({"down"});
  EXPECT_EQ(down.exit_code, 1) << "the first recording is not complete\n" << down.out << down.err;
}

/// What a run writes lies on one disk, unless somebody asks for another place.
TEST(FullDiskByDefault, ThereIsRoomForTheRunsOtherFiles) {
  const Bench bench;
  const SmallDisk home(bench.folder() / "home", 11'000);
  if (!home.problem().empty()) GTEST_SKIP() << home.problem();
  const Finished run = runProgram(programFolder() / "baton",
                                  {"run", bench.write("short.yaml", scenario("chunk_kB: 32")), "--json", "--domain",
                                   std::to_string(bench.domain())},
                                  home.folder());
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const Json result = Json::parse(run.out);
  EXPECT_EQ(result.at("state"), "finished");
  EXPECT_EQ(result.at("steps"), kShortSteps);
  EXPECT_NE(result.at("recording").at("summary").get<std::string>().find("min_free_MB"), std::string::npos) << result;
  EXPECT_TRUE(fs::exists(result.at("folder").get<std::string>() + "/result.json"));
  const std::string file = result.at("recording").at("path");
  EXPECT_EQ(bench.baton({"bag", "verify", file}).exit_code, 1);
}

}  // namespace
}  // namespace baton::test
