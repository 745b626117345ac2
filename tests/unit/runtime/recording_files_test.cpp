/// Which files make one recording, and in which order.
#include "runtime/recording_files.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "base/error.hpp"
#include "mcap/joined_reader.hpp"
#include "mcap/writer.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

class RecordingFiles : public testing::Test {
 protected:
  RecordingFiles() {
    std::string name = (fs::temp_directory_path() / "baton-files-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder = name;
  }
  ~RecordingFiles() override { fs::remove_all(folder); }

  struct Plan {
    std::string run{};         // empty: not of Baton
    std::string part{};        // its index
    std::string first{"run"};  // the name of the first part
    std::uint64_t begin_ns = 0;
    std::uint64_t end_ns = 0;
    std::string next{};         // the part after it
    std::string certificate{};  // JSON
    std::string profile{};
    bool is_cut_out = false;
  };
  std::string write(const std::string& name, const Plan& plan) const {
    mcap::WriterOptions options;
    options.profile = plan.profile;
    mcap::Writer writer(folder / name, options);
    if (!plan.run.empty()) writer.addMetadata("baton.run", {{"run", plan.run}, {"scenario", "s"}});
    if (!plan.part.empty()) writer.addMetadata("baton.part", {{"index", plan.part}, {"first", plan.first}});
    if (!plan.next.empty()) writer.addMetadata("baton.part_end", {{"next", plan.next}});
    if (!plan.certificate.empty()) {
      writer.addAttachment("certificate.json", "application/json", 0, 0, mcap::asBytes(plan.certificate));
    }
    if (plan.is_cut_out) writer.addMetadata("baton.cut", {{"file", "x"}});
    const mcap::ChannelId channel = writer.addChannel("t", "cdr", mcap::kNoSchema);
    for (const std::uint64_t time : {plan.begin_ns, plan.end_ns}) writer.write(channel, 1, time, time, {});
    writer.close();
    return (folder / name).string();
  }
  /// Part `index` of a recording of 10 ns a part.
  std::string writePart(const std::string& name, unsigned index, const std::string& run = "r") const {
    return write(name,
                 {.run = run, .part = std::to_string(index), .begin_ns = index * 10 + 1, .end_ns = index * 10 + 9});
  }
  static std::vector<std::string> names(const FoundRecording& found) {
    std::vector<std::string> result;
    for (const fs::path& path : found.files.paths()) result.push_back(path.filename().string());
    return result;
  }
  static std::string refusal(const RecordingWish& wish) {
    try {
      (void)findRecording(wish);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }

  using Texts = std::vector<std::string>;
  fs::path folder;
};

TEST_F(RecordingFiles, PartsComeInTheOrderOfTheirNumbersWhateverTheirNames) {
  const Texts given{writePart("a.mcap", 2), writePart("z.mcap", 0), writePart("m.mcap", 1)};
  const FoundRecording found = findRecording({.given = given});
  EXPECT_EQ(names(found), (Texts{"z.mcap", "m.mcap", "a.mcap"}));
  EXPECT_TRUE(found.missing.empty());
}

TEST_F(RecordingFiles, AFolderStandsForTheRecordingsInIt) {
  writePart("b.mcap", 0);
  writePart("a.mcap", 1);
  std::ofstream(folder / "notes.txt") << "no recording";
  EXPECT_EQ(names(findRecording({.given = {folder.string()}})), (Texts{"b.mcap", "a.mcap"}));
  fs::create_directory(folder / "empty");
  EXPECT_NE(refusal({.given = {(folder / "empty").string()}}).find("a folder with recordings"), std::string::npos);
  std::ofstream(folder / "empty/rosbag2_0.db3") << "SQLite format 3" << std::string(100, '\0');
  EXPECT_NE(refusal({.given = {(folder / "empty").string()}, .with_parts = true}).find("`ros2 bag convert`"),
            std::string::npos);
}

TEST_F(RecordingFiles, AFolderOfSomethingElseIsNamedForWhatItIs) {
  fs::create_directory(folder / "ros1");
  std::ofstream(folder / "ros1/a.bag") << "#ROSBAG V2.0\n" << std::string(100, 'x');
  EXPECT_NE(refusal({.given = {(folder / "ros1").string()}, .with_parts = true}).find("it is a ROS 1 bag"),
            std::string::npos);
  fs::create_directory(folder / "none");
  EXPECT_NE(refusal({.given = {(folder / "none").string()}}).find("give their folder, or a file"), std::string::npos);
}

TEST_F(RecordingFiles, OtherPartsAreFoundWhenAskedForByWhatTheySay) {
  const std::string middle = writePart("middle.mcap", 1);
  writePart("renamed.mcap", 0);
  writePart("run_0002.mcap", 2);
  writePart("run_0003.mcap", 3, "another");
  write("of_another_recording.mcap", {.run = "r", .part = "3", .first = "second"});
  write("cut_out.mcap", {.run = "r", .part = "3", .is_cut_out = true});
  std::ofstream(folder / "broken.mcap") << "no recording";
  EXPECT_EQ(names(findRecording({.given = {middle}})), (Texts{"middle.mcap"}));
  EXPECT_EQ(names(findRecording({.given = {middle}, .with_parts = true})),
            (Texts{"renamed.mcap", "middle.mcap", "run_0002.mcap"}));
}

TEST_F(RecordingFiles, AMissingPartIsNamedAndMakesTheExitCode) {
  const Texts given{writePart("a.mcap", 1), writePart("b.mcap", 3), writePart("c.mcap", 6)};
  const FoundRecording found = findRecording({.given = given});
  ASSERT_EQ(found.missing.size(), 2U);
  EXPECT_EQ(found.missing[0], "part 2 is missing between " + given[0] + " and " + given[1]);
  EXPECT_EQ(found.missing[1], "parts 4 to 5 are missing between " + given[1] + " and " + given[2]);
  ExitCode exit_code = ExitCode::kOk;
  EXPECT_EQ(findRecording({.given = given}, exit_code).paths().size(), 3U);
  EXPECT_EQ(exit_code, ExitCode::kFailed);
  exit_code = ExitCode::kOk;
  (void)findRecording({.given = {given[0]}}, exit_code);
  EXPECT_EQ(exit_code, ExitCode::kOk) << "a part alone is read as ever";
}

TEST_F(RecordingFiles, AMissingFirstOrLastPartIsNamedWhereAllAreWanted) {
  const auto writeOf = [&](unsigned index, const std::string& next, const std::string& certificate) {
    return write("p" + std::to_string(index) + ".mcap", {.run = "r",
                                                         .part = std::to_string(index),
                                                         .begin_ns = index * 10 + 1,
                                                         .end_ns = index * 10 + 9,
                                                         .next = next,
                                                         .certificate = certificate});
  };
  const std::string one = writeOf(1, "run_0002.mcap", ""), two = writeOf(2, "run_0003.mcap", "");
  // Who has not closed its last part has not said which it dropped itself.
  const Texts expected{"run_0003.mcap, in which it goes on, is missing after " + two};
  EXPECT_EQ(findRecording({.given = {one}, .with_parts = true}).missing, expected);
  EXPECT_EQ(missingParts({two, one}), expected);
  EXPECT_EQ(findRecording({.given = {folder.string()}}).missing, expected);
  EXPECT_TRUE(findRecording({.given = {one, two}}).missing.empty()) << "that is what was asked for";
  ExitCode exit_code = ExitCode::kOk;
  (void)findRecording({.given = {one}, .with_parts = true}, exit_code);
  EXPECT_EQ(exit_code, ExitCode::kFailed);
  const std::string three = writeOf(3, "", R"({"first_part": 1})");
  EXPECT_EQ(findRecording({.given = {one}, .with_parts = true}).missing, Texts{}) << "part 0 was dropped";
  EXPECT_EQ(missingParts({one, two, three}), Texts{});
  std::filesystem::remove(three);
  (void)writeOf(3, "", R"({"complete": true})");
  const Texts first{"part 0 is missing before " + one};
  EXPECT_EQ(findRecording({.given = {one}, .with_parts = true}).missing, first);
  EXPECT_EQ(missingParts({one, two, three}), first);
}

TEST_F(RecordingFiles, APartThatCannotBeReadIsNamed) {
  const std::string first = writePart("run.mcap", 0), last = writePart("run_0002.mcap", 2);
  std::ofstream(folder / "run_0001.mcap") << std::string(100, '\0');
  std::ofstream(folder / "notes_0001.mcap") << "of something else";
  write("named.mcap", {.run = "r", .part = "5", .first = "run.mcap", .begin_ns = 1, .end_ns = 9});
  std::string text;
  for (const std::string& one :
       findRecording({.given = {(folder / "named.mcap").string()}, .with_parts = true}).missing) {
    text += one + "\n";
  }
  EXPECT_NE(text.find("a part cannot be read and is left out: " + (folder / "run_0001.mcap").string()),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("notes_0001"), std::string::npos) << text;
  Texts unreadable;
  (void)filesOf({.given = {(folder / "named.mcap").string()}, .with_parts = true}, &unreadable);
  EXPECT_EQ(unreadable.size(), 1U);
}

TEST_F(RecordingFiles, FilesOfSeveralRunsAreRefusedWithWhatDiffers) {
  const std::string a = writePart("a.mcap", 0), b = writePart("b.mcap", 1, "other");
  EXPECT_NE(refusal({.given = {a, b}}).find("of different runs: run r and other"), std::string::npos)
      << refusal({.given = {a, b}});
  const std::string foreign = write("c.mcap", {});
  EXPECT_NE(refusal({.given = {a, foreign}}).find("c.mcap was not recorded by Baton"), std::string::npos);
  const std::string ros = write("d.mcap", {.profile = "ros2"});
  EXPECT_NE(refusal({.given = {foreign, ros}}).find("profile '' and 'ros2'"), std::string::npos);
}

TEST_F(RecordingFiles, NothingIsReadTwice) {
  const std::string a = writePart("a.mcap", 0);
  EXPECT_NE(refusal({.given = {a, a}}).find("the same file"), std::string::npos);
  EXPECT_NE(refusal({.given = {a, writePart("copy.mcap", 0)}}).find("both part 0"), std::string::npos);
  const std::string one = write("one.mcap", {.run = "r", .begin_ns = 0, .end_ns = 2'000'000'000});
  const std::string two = write("two.mcap", {.run = "r", .begin_ns = 1'500'000'000, .end_ns = 3'000'000'000});
  EXPECT_NE(refusal({.given = {two, one}}).find("which overlap by 0.500 s"), std::string::npos);
}

TEST_F(RecordingFiles, ADamagedMetadataRecordKeepsNothingFromBeingRead) {
  const std::string first = write("a.mcap", {.run = "r", .begin_ns = 10, .end_ns = 20});
  const std::string second = write("b.mcap", {.run = "r", .begin_ns = 30, .end_ns = 40, .is_cut_out = true});
  std::fstream file(second, std::ios::binary | std::ios::in | std::ios::out);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::string name = "baton.cut";
  const std::size_t record = bytes.find(name);
  ASSERT_NE(record, std::string::npos);
  file.clear();
  file.seekp(static_cast<std::streamoff>(record + name.size()));
  file.write("\xFF\xFF\xFF\x7F", 4);  // the length of its values
  file.close();
  ASSERT_THROW((void)mcap::Reader(second, {.on_damage = [](const auto&) {}}).metadata(), mcap::FormatError);
  const FoundRecording found = findRecording({.given = {second, first}});
  EXPECT_EQ(names(found), (Texts{"a.mcap", "b.mcap"}));
  const mcap::JoinedReader joined(found.files, [](const auto&, const auto&) {});
  EXPECT_EQ(joined.statistics().message_count, 4U);
}

TEST_F(RecordingFiles, WhatHasNoNumbersComesByItsTimes) {
  const std::string late = write("a.mcap", {.run = "r", .begin_ns = 50, .end_ns = 60});
  const std::string early = write("b.mcap", {.run = "r", .begin_ns = 10, .end_ns = 50, .is_cut_out = true});
  EXPECT_EQ(names(findRecording({.given = {late, early}})), (Texts{"b.mcap", "a.mcap"}));
  const std::string x = write("x.mcap", {.begin_ns = 20, .end_ns = 40});
  const std::string y = write("y.mcap", {.begin_ns = 10, .end_ns = 30});
  EXPECT_EQ(names(findRecording({.given = {x, y}})), (Texts{"y.mcap", "x.mcap"})) << "other people's may overlap";
}

}  // namespace
}  // namespace baton
