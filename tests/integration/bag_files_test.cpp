// Recordings of real runs in the hands of `baton bag`, and what is left of one whose recorder was killed or found no
// room.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "mcap/reader.hpp"
#include "mcap/writer.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

namespace fs = std::filesystem;

class BagFiles : public testing::Test {
 protected:
  [[nodiscard]] std::string record(const std::string& name, const std::string& scenario = shortContact()) const {
    std::string file = (bench.folder() / name).string();
    const Finished run = bench.baton({"run", bench.write(name + ".yaml", scenario), "--out", file});
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
    return file;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (bench.folder() / name).string(); }
  [[nodiscard]] int verify(const std::string& file) const { return bench.baton({"bag", "verify", file}).exit_code; }

  Bench bench;
};

TEST_F(BagFiles, AClockThatWasSetIsNamed) {
  mcap::Writer writer(path("foreign.mcap"), {});
  const mcap::ChannelId channel = writer.addChannel("numbers", "cdr", writer.addSchema("Number", "omgidl", {}), {});
  const mcap::Bytes payload(8);
  constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000, kHour_ns = 3'600'000'000'000;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const std::uint64_t time_ns = kStart_ns + i * 1'000'000 + (i < 10 ? 0 : kHour_ns);
    writer.write(channel, i + 1, time_ns, time_ns, payload);
  }
  writer.close();
  for (const char* command : {"info", "verify"}) {
    const Finished json = bench.baton({"bag", command, path("foreign.mcap"), "--json"});
    const nlohmann::json clock = nlohmann::json::parse(json.out).at("clock");
    ASSERT_EQ(clock.size(), 1U) << command << json.out;
    EXPECT_EQ(clock[0].get<std::string>().find("nothing was logged for 3600.001 s from 0.009 s on"), 0U) << clock;
    const Finished text = bench.baton({"bag", command, path("foreign.mcap")});
    EXPECT_NE(text.out.find("note        nothing was logged"), std::string::npos) << text.out;
    EXPECT_EQ(text.exit_code, command == std::string("info") ? 0 : 1) << "a pause is no fault";
  }
}

TEST_F(BagFiles, ARunIsProvenCompleteAndSoIsACopyOfIt) {
  const std::string file = record("run.mcap");
  const Finished verified = bench.baton({"bag", "verify", file, "--json"});
  EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
  const nlohmann::json found = nlohmann::json::parse(verified.out);
  EXPECT_EQ(found.at("verdict"), "complete");
  // Those of plant, environment, trajectory and four controllers prove it. The supervisor has written nothing that
  // counts: its own may come later than the end of the file.
  EXPECT_GE(found.at("manifests"), 7);
  EXPECT_LE(found.at("manifests"), 8);
  for (const auto& row : found.at("streams")) {
    if (row.contains("sent")) {
      EXPECT_EQ(row.at("sent"), row.at("count")) << row;
      EXPECT_EQ(row.at("sent_hash"), row.at("stream_hash")) << row;
    }
  }

  const nlohmann::json copied = bench.batonJson({"bag", "recover", file, path("copy.mcap"), "--json"});
  EXPECT_TRUE(copied.at("whole")) << copied;
  EXPECT_EQ(copied.at("lost_B"), 0);
  EXPECT_EQ(verify(path("copy.mcap")), 0);
  EXPECT_EQ(readStreams(path("copy.mcap")), readStreams(file));
  EXPECT_EQ(bench.baton({"bag", "hash", file, path("copy.mcap")}).exit_code, 0);

  // Nothing that is there is overwritten unless it is asked for, and never what is read.
  using Words = std::vector<std::string>;
  for (const Words& copy : {Words{"recover", file, path("copy.mcap")}, Words{"merge", file, path("copy.mcap")},
                            Words{"cut", file, path("copy.mcap"), "--to", "1"}}) {
    Words arguments{"bag"};
    arguments.insert(arguments.end(), copy.begin(), copy.end());
    const Finished refused = bench.baton(arguments);
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.err.find("give --overwrite"), std::string::npos) << copy[0] << refused.err;
  }
  EXPECT_EQ(bench.baton({"bag", "recover", file, path("copy.mcap"), "--overwrite"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "recover", file, file, "--overwrite"}).exit_code, 2);
  EXPECT_EQ(verify(file), 0);
  EXPECT_EQ(bench.baton({"bag", "recover", path("absent.mcap"), path("new.mcap")}).exit_code, 3);
  EXPECT_EQ(bench.baton({"bag", "recover", bench.write("text.mcap", "hello"), path("new.mcap")}).exit_code, 2);
  EXPECT_EQ(bench.baton({"bag", "recover", file, path("no/such/folder.mcap")}).exit_code, 3);
  EXPECT_EQ(bench.baton({"bag", "recover", file, "/proc/nothing.mcap"}).exit_code, 3) << "where nobody may write";
  EXPECT_EQ(bench.baton({"bag", "recover", file, "/dev/full", "--overwrite"}).exit_code, 1);
  EXPECT_TRUE(fs::exists("/dev/full"));
  EXPECT_FALSE(fs::exists(path("new.mcap")));
}

TEST_F(BagFiles, ACutAndADamagedRecordingAreFoundOutAndRecovered) {
  const std::string file = record("run.mcap");
  const std::uint64_t size = fs::file_size(file);
  fs::copy_file(file, path("cut.mcap"));
  fs::resize_file(path("cut.mcap"), size * 2 / 3);
  EXPECT_EQ(verify(path("cut.mcap")), 1);
  EXPECT_EQ(bench.baton({"bag", "info", path("cut.mcap")}).exit_code, 1);
  EXPECT_EQ(bench.baton({"bag", "hash", path("cut.mcap")}).exit_code, 1);
  EXPECT_EQ(bench.baton({"metrics", path("cut.mcap")}).exit_code, 1);
  const Finished recovered = bench.baton({"bag", "recover", path("cut.mcap"), path("whole.mcap"), "--json"});
  EXPECT_EQ(recovered.exit_code, 1) << "something was lost";
  const nlohmann::json found = nlohmann::json::parse(recovered.out);
  ASSERT_EQ(found.at("lost").size(), 1U) << found;
  EXPECT_EQ(found.at("lost").at(0).at("from_B").get<std::uint64_t>() + found.at("lost_B").get<std::uint64_t>(),
            size * 2 / 3);
  EXPECT_EQ(readStreams(path("whole.mcap")), readStreams(path("cut.mcap")));
  EXPECT_EQ(verify(path("whole.mcap")), 1) << "it is readable, and still not complete";
  EXPECT_EQ(bench.baton({"bag", "info", path("whole.mcap")}).exit_code, 1);

  fs::copy_file(file, path("damaged.mcap"));
  {
    std::fstream bytes(path("damaged.mcap"), std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekp(static_cast<std::streamoff>(size / 2));
    bytes << std::string(30'000, '\0');  // more than the message indexes between two chunks
  }
  EXPECT_EQ(verify(path("damaged.mcap")), 2);
  EXPECT_EQ(bench.baton({"bag", "recover", path("damaged.mcap"), path("rest.mcap")}).exit_code, 1);
  EXPECT_EQ(verify(path("rest.mcap")), 1) << "it has no certificate any more";
}

TEST_F(BagFiles, RunsAreMergedAndKeptApart) {
  const std::string one = record("one.mcap"), two = record("two.mcap");
  const nlohmann::json merged = bench.batonJson({"bag", "merge", one, two, path("both.mcap"), "--json"});
  const mcap::Reader first(one), second(two), both(path("both.mcap"));
  EXPECT_EQ(merged.at("messages"), both.statistics().message_count);
  EXPECT_EQ(both.statistics().message_count, first.statistics().message_count + second.statistics().message_count);
  EXPECT_EQ(both.channels().size(), first.channels().size() + second.channels().size());
  EXPECT_EQ(both.schemas().size(), first.schemas().size());
  std::uint64_t latest = 0;
  both.forEachMessage({.order = mcap::MessageFilter::Order::kFile}, [&](const mcap::MessageView& message) {
    ASSERT_GE(message.log_time_ns, latest);
    latest = message.log_time_ns;
  });
  std::set<std::string> names;
  for (const mcap::Metadata& record : both.metadata()) names.insert(record.name);
  for (const mcap::AttachmentIndex& attachment : both.attachments()) names.insert(attachment.name);
  // What happened may be the same in both or not.
  std::erase_if(names, [](const std::string& name) { return name.ends_with("events.json"); });
  EXPECT_EQ(names, (std::set<std::string>{"parameters.json", "one/baton.run", "two/baton.run",
                                          "baton.original_certificate", "scenario.yaml", "robot.yaml",
                                          "one/original_certificate.json", "two/original_certificate.json"}));
  EXPECT_EQ(verify(path("both.mcap")), 1) << "no certificate holds for two runs";
}

TEST_F(BagFiles, APartIsCutOutAndSaysSo) {
  const std::string file = record("run.mcap");
  const mcap::Reader whole(file);
  // Of the steps, which begin when everybody has been found, and that takes as long as it takes.
  std::uint64_t begin = 0, end = 0;
  whole.forEachMessage({.topics = {"plant_state"}}, [&](const mcap::MessageView& view) {
    if (begin == 0) begin = view.log_time_ns;
    end = view.log_time_ns;
  });
  const auto at = [&](std::uint64_t time_ns) {
    return std::to_string(static_cast<double>(time_ns - whole.statistics().start_time_ns) * 1e-9);
  };
  const nlohmann::json cut =
      bench.batonJson({"bag", "cut", file, path("part.mcap"), "--from", at(begin + (end - begin) / 4), "--to",
                       at(begin + (end - begin) / 2), "--topics", "plant_state,contact", "--json"});
  const mcap::Reader part(path("part.mcap"));
  EXPECT_GT(part.statistics().message_count, 0U);
  EXPECT_EQ(part.statistics().message_count, cut.at("messages"));
  EXPECT_EQ(cut.at("messages").get<std::uint64_t>() + cut.at("left_out").get<std::uint64_t>(),
            whole.statistics().message_count);
  std::set<std::string> topics;
  for (const auto& [id, channel] : part.channels()) topics.insert(channel.topic);
  EXPECT_EQ(topics, (std::set<std::string>{"contact", "plant_state"}));
  EXPECT_GE(part.statistics().start_time_ns, begin + (end - begin) / 4 - 1000);
  EXPECT_LE(part.statistics().end_time_ns, begin + (end - begin) / 2 + 1000);
  std::set<std::string> names;
  for (const mcap::Metadata& record : part.metadata()) names.insert(record.name);
  EXPECT_EQ(names, (std::set<std::string>{"baton.run", "baton.original_certificate", "baton.cut"}));
  EXPECT_EQ(verify(path("part.mcap")), 1);
  EXPECT_EQ(bench.baton({"bag", "info", path("part.mcap")}).exit_code, 1);

  EXPECT_EQ(bench.baton({"bag", "cut", file, path("none.mcap")}).exit_code, 2) << "nothing is to be cut";
  const Finished unknown = bench.baton({"bag", "cut", file, path("none.mcap"), "--topics", "plant_stat"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("did you mean 'plant_state'"), std::string::npos) << unknown.err;
  EXPECT_EQ(bench.baton({"bag", "cut", file, path("none.mcap"), "--from", "2", "--to", "1"}).exit_code, 2);
  const Finished beyond = bench.baton({"bag", "cut", file, path("none.mcap"), "--from", "1000"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_NE(beyond.err.find("--from: expected a time in " + file + ", which ends"), std::string::npos) << beyond.err;
  // A topic that is not in the chosen time.
  fs::copy_file(file, path("kept.mcap"));
  const Finished nothing =
      bench.baton({"bag", "cut", file, path("kept.mcap"), "--overwrite", "--topics", "swap_outcome", "--to", "0"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_NE(nothing.err.find("expected messages in these topics and times"), std::string::npos) << nothing.err;
  EXPECT_EQ(fs::file_size(path("kept.mcap")), fs::file_size(file)) << "what was there stays";
  EXPECT_FALSE(fs::exists(path("none.mcap")));
}

/// kill -9 of the recorder when so much is in its file, at a place that is any.
class KilledRecorder : public testing::TestWithParam<unsigned> {};

TEST_P(KilledRecorder, LeavesARecordingThatIsMadeWholeAgain) {
  std::mt19937 generator(GetParam());
  const std::uint64_t bytes = 50'000 + generator() % 1'500'000;
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  ASSERT_TRUE(eventually([&] { return fs::file_size(run.recording) >= bytes; }));
  ASSERT_EQ(kill(run.pidOf("recorder"), SIGKILL), 0);
  std::ignore = run.result();
  EXPECT_EQ(bench.baton({"bag", "verify", run.recording}).exit_code, 1) << "cut, not damaged";

  const std::string out = (bench.folder() / "whole.mcap").string();
  const Finished recovered = bench.baton({"bag", "recover", run.recording, out});
  EXPECT_EQ(recovered.exit_code == 0 || recovered.exit_code == 1, true) << recovered.err;
  const mcap::Reader reader(out);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_TRUE(reader.info().has_summary);
  EXPECT_EQ(readStreams(out), readStreams(run.recording));
  // Of each writer of the loop all of it, from its first message up to some one.
  std::map<mcap::ChannelId, std::uint32_t> latest;
  reader.forEachMessage({.topics = {"plant_state", "reference", "contact", "joint_command"}},
                        [&](const mcap::MessageView& message) {
                          std::uint32_t& last = latest[message.channel->id];
                          ASSERT_EQ(message.sequence, last + 1) << message.channel->topic;
                          last = message.sequence;
                        });
  EXPECT_GE(latest.size(), 4U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, KilledRecorder, testing::Range(1U, 7U));

/// A run whose files may not grow beyond a limit, as on a disk that is full.
TEST_F(BagFiles, ARecordingThatFindsNoRoomEndsWithAWordAndIsReadableUpToThere) {
  const std::string file = path("full.mcap");
  const std::string run = "'" + (programFolder() / "baton").string() + "' run '" +
                          bench.write("short.yaml", shortContact()) + "' --domain " + std::to_string(bench.domain()) +
                          " --out '" + file + "'";
  const Finished finished = runProgram("/bin/sh", {"-c", "ulimit -f 200; exec " + run}, bench.folder());  // of 512 B
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  EXPECT_NE((finished.out + finished.err).find("File too large"), std::string::npos) << finished.out << finished.err;
  EXPECT_TRUE(processesWith(bench.folder().string()).empty());
  EXPECT_EQ(fs::file_size(file), 200U * 512);
  EXPECT_EQ(verify(file), 1);
  EXPECT_EQ(bench.baton({"bag", "recover", file, path("whole.mcap")}).exit_code, 1);
  EXPECT_GT(mcap::Reader(path("whole.mcap")).statistics().message_count, 0U);
}

TEST_F(BagFiles, WhatIsNoFileIsNotReplacedByARecording) {
  fs::create_directory(path("folder"));
  const Finished run =
      bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", path("folder"), "--overwrite"});
  EXPECT_EQ(run.exit_code, 2) << run.out << run.err;
  EXPECT_NE(run.err.find("a folder or a device"), std::string::npos) << run.err;
  EXPECT_TRUE(fs::is_directory(path("folder")));
}

TEST_F(BagFiles, ACopyThatFindsNoRoomIsNotLeftLyingAbout) {
  const std::string file = record("run.mcap");
  const std::string recover =
      "'" + (programFolder() / "baton").string() + "' bag recover '" + file + "' '" + path("copy.mcap") + "'";
  const Finished finished = runProgram("/bin/sh", {"-c", "ulimit -f 100; exec " + recover}, bench.folder());
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  EXPECT_NE(finished.err.find("File too large"), std::string::npos) << finished.err;
  EXPECT_FALSE(fs::exists(path("copy.mcap")));
}

}  // namespace
}  // namespace baton::test
