// What a recorder can be told, by its scenario and while it runs: which topics, how the files lie on the disk, when.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "dds/codec.hpp"
#include "mcap/reader.hpp"
#include "mcap/repeated.hpp"
#include "msg/loop.h"
#include "runtime/recording_parts.hpp"
#include "support/live_run.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

Json certificateOf(const fs::path& file) {
  const mcap::Reader reader(file);
  for (const mcap::AttachmentIndex& one : reader.attachments()) {
    if (one.name != "certificate.json") continue;
    const mcap::Bytes bytes = reader.readAttachment(one);
    return Json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  throw std::runtime_error(file.string() + " has no certificate");
}

std::vector<std::uint64_t> stateSteps(const fs::path& file) {
  std::vector<std::uint64_t> steps;
  for (const auto& state : decodeStream<msg::PlantState>(readStreams(file.string())[{"plant_state", "plant"}])) {
    steps.push_back(state.step());
  }
  return steps;
}

std::vector<std::uint64_t> range(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> steps;
  for (std::uint64_t step = first; step <= last; ++step) steps.push_back(step);
  return steps;
}

std::vector<std::uint64_t> operator+(std::vector<std::uint64_t> a, const std::vector<std::uint64_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Json officialReader(const Bench& bench, const fs::path& file) {
  const Finished reader = runProgram(
      "/bin/sh", {"-c", "node '" BATON_TEST_INTEROP "/read_mcap.mjs' '" + file.string() + "'"}, bench.folder());
  EXPECT_EQ(reader.exit_code, 0) << reader.out << reader.err;
  return Json::parse(reader.out);
}

/// The proof from the bytes, which a recording has to pass whatever was left out of it on purpose.
void expectVerified(const Bench& bench, const std::vector<fs::path>& files) {
  std::vector<std::string> arguments{"bag", "verify"};
  for (const fs::path& file : files) arguments.push_back(file.string());
  const Finished verified = bench.baton(arguments);
  EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
}

struct RecordedRun {
  explicit RecordedRun(const std::string& recording)
      : file(bench.folder() / "run.mcap"),
        result(bench.batonJson({"run", bench.write("short.yaml", shortContact("recording: {" + recording + "}\n")),
                                "--out", file.string(), "--json"})) {}
  Bench bench;
  fs::path file;
  Json result;
};

TEST(Record, TopicsAreLeftOutOnPurposeAndTheRunIsCompleteWithoutThem) {
  // Of what the plant's credit hangs on, too: it is received and not written.
  const RecordedRun run("except: [shadow_command, '*_status', contact]");
  ASSERT_EQ(run.result.at("exit_code"), 0) << run.result;
  EXPECT_EQ(run.result.at("recording").at("complete"), true);
  const Streams streams = readStreams(run.file.string());
  for (const auto& [key, payloads] : streams) {
    EXPECT_NE(key.first, "shadow_command");
    EXPECT_NE(key.first, "contact");
    EXPECT_FALSE(key.first.ends_with("_status")) << key.first;
  }
  EXPECT_EQ(stateSteps(run.file), range(0, kShortSteps));
  const Json certificate = certificateOf(run.file);
  EXPECT_EQ(certificate.at("complete"), true);
  const std::set<std::string> left_out = certificate.at("left_out");
  for (const char* topic : {"shadow_command", "contact", "sim_status", "service_status"}) {
    EXPECT_TRUE(left_out.contains(topic)) << topic;
  }
  EXPECT_FALSE(left_out.contains("plant_state"));
  expectVerified(run.bench, {run.file});

  // What the file says of the run, in plain text.
  const mcap::Reader reader(run.file);
  std::set<std::string> names;
  for (const mcap::AttachmentIndex& one : reader.attachments()) names.insert(one.name);
  EXPECT_EQ(names, (std::set<std::string>{"scenario.yaml", "robot.yaml", "parameters.json", "events.json",
                                          "certificate.json"}));
  for (const mcap::Metadata& one : reader.metadata()) {
    if (one.name != "baton.run") continue;
    for (const char* key : {"scenario", "robot", "version", "compiler", "flags", "build_id", "seed", "idl_hash", "host",
                            "system", "begun", "mathematics", "libc", "dds", "processor"}) {
      EXPECT_TRUE(one.values.contains(key)) << key;
    }
  }
}

TEST(Record, OnlyTheTopicsThatAreNamedAreRecorded) {
  const RecordedRun run("topics: [plant_state, 'swap_*'], compression: lz4, level: 9, chunk_kB: 32");
  ASSERT_EQ(run.result.at("exit_code"), 0) << run.result;
  std::set<std::string> topics;
  for (const auto& [key, payloads] : readStreams(run.file.string())) topics.insert(key.first);
  EXPECT_EQ(topics, (std::set<std::string>{"plant_state", "swap_plan", "swap_ack", "swap_outcome", "swap_report"}));
  EXPECT_EQ(stateSteps(run.file), range(0, kShortSteps));
  EXPECT_EQ(officialReader(run.bench, run.file).at("topics").size(), 5U);
  expectVerified(run.bench, {run.file});
}

TEST(Record, APatternThatNoTopicMatchesIsTold) {
  const RecordedRun run("topics: [plant_state, contcat], except: ['*_stats']");
  ASSERT_EQ(run.result.at("exit_code"), 0) << run.result;
  EXPECT_NE(run.result.at("recording").at("summary").get<std::string>().find("no topic matches contcat"),
            std::string::npos)
      << run.result;
  EXPECT_EQ(certificateOf(run.file).at("unmatched"), Json::parse(R"(["contcat"])"));
  const Finished logs = run.bench.baton({"logs", "recorder"});
  EXPECT_NE(logs.out.find("expected a pattern that matches a topic, found contcat"), std::string::npos) << logs.out;
  expectVerified(run.bench, {run.file});
}

TEST(Record, PartsFollowEachOtherAndTheLastOneVouchesForAll) {
  const RecordedRun run("compression: none, chunk_kB: 32, split_MB: 0.4");
  ASSERT_EQ(run.result.at("exit_code"), 0) << run.result;
  std::vector<fs::path> parts{run.file};
  for (const fs::path& part : furtherPartsOf(run.file)) parts.push_back(part);
  ASSERT_GE(parts.size(), 3U);
  std::vector<std::uint64_t> steps;
  std::uint64_t messages = 0;
  for (const fs::path& part : parts) {
    steps = steps + stateSteps(part);
    const Json seen = officialReader(run.bench, part);
    // What a late joiner would have been given is in front, and counts where it was recorded.
    const std::uint64_t repeated = mcap::Repeated(mcap::Reader(part)).count();
    EXPECT_EQ(repeated == 0, part == parts.front());
    messages += seen.at("messages").get<std::uint64_t>() - repeated;
    EXPECT_EQ(seen.at("decoded"), seen.at("messages")) << "each has its own schemas";
    const Finished info = run.bench.baton({"bag", "info", part.string()});
    EXPECT_EQ(info.exit_code, 0) << info.out << info.err;
  }
  EXPECT_EQ(steps, range(0, kShortSteps)) << "none lost at a seam, none twice";
  EXPECT_EQ(run.result.at("recording").at("messages"), messages);
  const Json certificate = certificateOf(parts.back());
  EXPECT_EQ(certificate.at("complete"), true);
  EXPECT_EQ(certificate.at("parts").size(), parts.size());
  EXPECT_THROW((void)certificateOf(parts.front()), std::runtime_error);
  expectVerified(run.bench, parts);

  // Again under the same name: what is left of the first is in the way, unless it may go.
  const std::string scenario = (run.bench.folder() / "short.yaml").string();
  const Finished refused = run.bench.baton({"run", scenario, "--out", run.file.string()});
  EXPECT_EQ(refused.exit_code, 3) << refused.err;
  fs::remove(run.file);
  const Finished still = run.bench.baton({"run", scenario, "--out", run.file.string()});
  EXPECT_EQ(still.exit_code, 3);
  EXPECT_NE(still.err.find("run_0001.mcap"), std::string::npos) << still.err;
  // What only has the name of a part is somebody else's.
  const fs::path other = run.bench.write("run_2024.mcap", "precious");
  const Finished spared = run.bench.baton({"run", scenario, "--out", run.file.string(), "--overwrite"});
  EXPECT_EQ(spared.exit_code, 2);
  EXPECT_NE(spared.err.find("run_2024.mcap, which is there and is none"), std::string::npos) << spared.err;
  EXPECT_EQ(fs::file_size(other), 8U);
  fs::remove(other);
  const Finished replaced = run.bench.baton({"run", scenario, "--out", run.file.string(), "--overwrite"});
  EXPECT_EQ(replaced.exit_code, 0) << replaced.out << replaced.err;
}

TEST(Record, WhenItsBudgetIsSpentTheRecordingEndsInOrderAndTheRunGoesOn) {
  const RecordedRun run("compression: none, chunk_kB: 32, max_MB: 0.8");
  EXPECT_EQ(run.result.at("exit_code"), 1) << "the recording is not complete";
  EXPECT_EQ(run.result.at("state"), "finished");
  EXPECT_EQ(run.result.at("steps"), kShortSteps) << "nobody waited for the recorder";
  EXPECT_LE(fs::file_size(run.file), 800'000U);
  EXPECT_GE(fs::file_size(run.file), 400'000U);
  const mcap::Reader reader(run.file);
  EXPECT_TRUE(reader.info().is_complete) << "finished, with its index";
  const std::vector<std::uint64_t> steps = stateSteps(run.file);
  EXPECT_EQ(steps, range(0, steps.back()));
  EXPECT_LT(steps.back(), static_cast<std::uint64_t>(kShortSteps));
  const Json certificate = certificateOf(run.file);
  EXPECT_EQ(certificate.at("complete"), false);
  EXPECT_NE(certificate.at("ended").get<std::string>().find("max_MB"), std::string::npos);
  (void)officialReader(run.bench, run.file);
  const Finished logs = run.bench.baton({"logs", "recorder"});
  EXPECT_NE(logs.out.find("the recording ends at step"), std::string::npos) << logs.out;
}

TEST(Record, ABudgetIsKeptByDroppingTheOldestParts) {
  const RecordedRun run("compression: none, chunk_kB: 32, split_MB: 0.3, max_MB: 1, when_full: drop_oldest");
  ASSERT_EQ(run.result.at("exit_code"), 0) << run.result;
  EXPECT_FALSE(fs::exists(run.file));
  std::uint64_t bytes = 0;
  std::vector<std::uint64_t> steps;
  fs::path last;
  expectVerified(run.bench, furtherPartsOf(run.file));
  for (const fs::path& part : furtherPartsOf(run.file)) {
    bytes += fs::file_size(part);
    steps = steps + stateSteps(part);
    last = part;
  }
  EXPECT_LE(bytes, 1'000'000U);
  ASSERT_FALSE(steps.empty());
  EXPECT_EQ(steps, range(steps.front(), kShortSteps)) << "the latest";
  const Json certificate = certificateOf(last);
  EXPECT_EQ(certificate.at("complete"), true);
  ASSERT_EQ(certificate.at("holes").size(), 1U);
  EXPECT_EQ(certificate.at("holes").at(0).at("from_step"), 0);
}

TEST(Record, WhereTheDiskRunsLowTheRecordingEndsAndTheRunGoesOn) {
  const RecordedRun run("min_free_MB: 1e9");
  EXPECT_EQ(run.result.at("exit_code"), 1);
  EXPECT_EQ(run.result.at("state"), "finished");
  EXPECT_EQ(run.result.at("steps"), kShortSteps);
  EXPECT_TRUE(mcap::Reader(run.file).info().is_complete);
  EXPECT_NE(certificateOf(run.file).at("ended").get<std::string>().find("min_free_MB"), std::string::npos);
}

/// A run that is told what to do step by step: what is asked of the recorder has its exact place.
struct SteppedRun {
  explicit SteppedRun(const std::string& recording, const std::vector<std::string>& options = {"--paused"})
      : run(bench, restingContact(recording.empty() ? "" : "recording: {" + recording + "}\n"), options) {}
  void step(int count) {
    const Finished stepped = bench.baton({"sim", "step", std::to_string(count)});
    EXPECT_EQ(stepped.exit_code, 0) << stepped.out << stepped.err;
    at += static_cast<std::uint64_t>(count);
    EXPECT_TRUE(eventually([&] { return status().at("acknowledged_step") >= at; }));
  }
  [[nodiscard]] Json status() const { return bench.batonJson({"record", "status", "--json"}); }
  Json record(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "record");
    arguments.emplace_back("--json");
    return bench.batonJson(arguments);
  }
  [[nodiscard]] fs::path file(const std::string& name) const { return bench.folder() / name; }

  Bench bench;
  LiveRun run;
  std::uint64_t at = 0;
};

TEST(Record, IsStartedPausedResumedAndStoppedWhileTheRunGoesOn) {
  SteppedRun one("", {"--paused", "--record-later"});
  one.step(50);
  EXPECT_EQ(one.status().at("state"), "stopped");
  EXPECT_EQ(one.bench.baton({"record", "pause"}).exit_code, 1) << "there is nothing to pause";
  const Json started = one.record({"start", "--out", one.file("a.mcap").string()});
  EXPECT_EQ(started.at("accepted"), true) << started;
  EXPECT_EQ(started.at("step"), 50);
  EXPECT_EQ(started.at("path"), one.file("a.mcap").string());
  EXPECT_EQ(one.bench.baton({"record", "start"}).exit_code, 1) << "it records already";
  one.step(50);
  EXPECT_EQ(one.record({"pause"}).at("state"), "paused");
  one.step(50);
  EXPECT_EQ(one.status().at("state"), "paused");
  EXPECT_EQ(one.record({"resume"}).at("state"), "recording");
  one.step(50);
  const Json stopped = one.record({"stop"});
  EXPECT_EQ(stopped.at("state"), "stopped");
  EXPECT_NE(stopped.at("text").get<std::string>().find("complete"), std::string::npos) << stopped;
  one.step(10);
  EXPECT_EQ(one.record({"start", "--out", one.file("b.mcap").string()}).at("accepted"), true);
  one.step(30);
  const Finished down = one.bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;

  EXPECT_EQ(stateSteps(one.file("a.mcap")), range(51, 100) + range(151, 200));
  const Json a = certificateOf(one.file("a.mcap"));
  EXPECT_EQ(a.at("complete"), true);
  EXPECT_EQ(a.at("run_is_over"), false);
  EXPECT_EQ(a.at("ended"), "stopped on request");
  ASSERT_EQ(a.at("holes").size(), 1U);
  EXPECT_EQ(a.at("holes").at(0).at("from_step"), 101);
  EXPECT_EQ(a.at("holes").at(0).at("to_step"), 150);
  EXPECT_EQ(a.at("holes").at(0).at("reason"), "paused");

  EXPECT_EQ(stateSteps(one.file("b.mcap")), range(211, 240));
  const Json b = certificateOf(one.file("b.mcap"));
  EXPECT_EQ(b.at("complete"), true) << b.at("problems");
  EXPECT_EQ(b.at("run_is_over"), true);
  EXPECT_FALSE(fs::exists(one.run.recording)) << "nothing was recorded there";
  expectVerified(one.bench, {one.file("a.mcap")});
  expectVerified(one.bench, {one.file("b.mcap")});
}

TEST(Record, TheStepsThatAreToldAreThoseOfTheHole) {
  const Bench bench;
  const LiveRun run(bench, restingContact());
  const auto stepOf = [&](const char* action) {
    return bench.batonJson({"record", action, "--json"}).at("step").get<std::uint64_t>();
  };
  std::vector<std::pair<std::uint64_t, std::uint64_t>> told;
  for (int i = 0; i < 4; ++i) {
    const std::uint64_t paused = stepOf("pause");
    told.emplace_back(paused + 1, stepOf("resume"));
    run.waitForStep(told.back().second + 50);  // so that each hole has an edge
  }
  const Finished down = bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> holes;
  const Json certificate = certificateOf(run.recording);
  for (const Json& hole : certificate.at("holes")) {
    holes.emplace_back(hole.at("from_step"), hole.at("to_step"));
  }
  EXPECT_EQ(told, holes);
  const std::vector<std::uint64_t> steps = stateSteps(run.recording);
  for (const auto& [from, to] : holes) {
    EXPECT_TRUE(std::ranges::binary_search(steps, from - 1) && std::ranges::binary_search(steps, to + 1));
    EXPECT_FALSE(std::ranges::binary_search(steps, from) || std::ranges::binary_search(steps, to));
  }
}

TEST(Record, APauseThatLastsToTheEndLeavesNobodyUnvouched) {
  SteppedRun one("", {"--paused"});
  one.step(50);
  EXPECT_EQ(one.record({"pause"}).at("state"), "paused");
  one.step(50);
  const Finished down = one.bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_EQ(certificateOf(one.run.recording).at("run_is_over"), true);
  EXPECT_EQ(stateSteps(one.run.recording), range(0, 50));
  expectVerified(one.bench, {one.run.recording});
}

TEST(Record, ARunThatWasNeverRecordedIsNone) {
  SteppedRun one("start: on_request");
  one.step(20);
  const Finished down = one.bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_NE(down.out.find("none: nothing was recorded: `baton record start`"), std::string::npos) << down.out;
  EXPECT_EQ(down.out.find(one.run.recording), std::string::npos) << "no file that is not there is named";
  EXPECT_TRUE(one.run.result().at("recording").at("path").is_null());
  EXPECT_FALSE(fs::exists(one.run.recording));
}

TEST(Record, ARingIsWrittenOnRequestAndAtTheEnd) {
  SteppedRun one("ring_s: 0.02");  // 40 steps
  one.step(200);
  EXPECT_EQ(one.status().at("ring"), true);
  EXPECT_EQ(one.bench.baton({"record", "stop"}).exit_code, 1) << "a ring is neither started nor stopped";
  const Json snapshot = one.record({"snapshot", "--out", one.file("shot.mcap").string()});
  ASSERT_EQ(snapshot.at("accepted"), true) << snapshot;
  const Json named = one.record({"snapshot"});
  EXPECT_EQ(named.at("path"), one.file("live_step200.mcap").string());
  EXPECT_FALSE(fs::exists(one.run.recording)) << "not before the end";
  one.step(100);
  const Finished down = one.bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;

  EXPECT_EQ(stateSteps(one.file("shot.mcap")), range(160, 200));
  EXPECT_EQ(stateSteps(one.file("live_step200.mcap")), range(160, 200));
  EXPECT_EQ(stateSteps(one.run.recording), range(260, 300));
  for (const fs::path& file : {one.file("shot.mcap"), fs::path(one.run.recording)}) {
    EXPECT_EQ(certificateOf(file).at("complete"), true) << certificateOf(file).at("problems");
    // What was said before the ring's time and still holds is there.
    const Streams streams = readStreams(file.string());
    EXPECT_TRUE(streams.contains({"service_status", "plant"}));
    EXPECT_TRUE(streams.contains({"parameter_status", "tracking"}));
    (void)officialReader(one.bench, file);
    expectVerified(one.bench, {file});
  }
  EXPECT_EQ(certificateOf(one.file("shot.mcap")).at("from_step"), 160);
}

TEST(Record, ASnapshotThatWouldFillTheDiskIsRefused) {
  SteppedRun one("ring_s: 0.02, min_free_MB: 1e9");
  one.step(50);
  const Json refused = one.record({"snapshot", "--out", one.file("shot.mcap").string()});
  EXPECT_EQ(refused.at("accepted"), false);
  EXPECT_NE(refused.at("text").get<std::string>().find("recording.min_free_MB"), std::string::npos) << refused;
  EXPECT_FALSE(fs::exists(one.file("shot.mcap")));
  const Finished down = one.bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
}

TEST(Record, WhatIsLostInRealTimeIsCountedByWriterAndIsAGapInTheCertificate) {
  const Bench bench;
  const LiveRun run(bench, endlessContact("mode: realtime\n"));
  const int recorder = run.pidOf("recorder");
  run.waitForStep(200);
  // Stopped for longer than the writers remember.
  ASSERT_EQ(kill(recorder, SIGSTOP), 0);
  const std::uint64_t from = bench.batonJson({"status", "--json"}).at("step");
  run.waitForStep(from + 8000);
  ASSERT_EQ(kill(recorder, SIGCONT), 0);
  Json status;
  // What was lost before a second file began is no loss of that one. A stream's next sample shows it.
  EXPECT_TRUE(eventually([&] {
    status = bench.batonJson({"record", "status", "--json"});
    return std::ranges::any_of(status.at("losses"), [](const auto& one) { return one.at("topic") == "plant_state"; });
  })) << status;
  EXPECT_GT(status.at("lost"), 0);
  ASSERT_FALSE(status.at("losses").empty());
  EXPECT_GT(status.at("losses").at(0).at("lost"), 0);
  run.waitForStep(bench.batonJson({"status", "--json"}).at("step").get<std::uint64_t>() + 3000);
  EXPECT_EQ(bench.baton({"record", "stop"}).exit_code, 0);
  const fs::path second = bench.folder() / "second.mcap";
  run.waitForStep(bench.batonJson({"status", "--json"}).at("step").get<std::uint64_t>() + 200);
  EXPECT_EQ(bench.baton({"record", "start", "--out", second.string()}).exit_code, 0);
  run.waitForStep(bench.batonJson({"status", "--json"}).at("step").get<std::uint64_t>() + 200);
  const Finished down = bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 1) << down.out << down.err;
  const Json certificate = certificateOf(run.recording);
  EXPECT_EQ(certificate.at("complete"), false);
  ASSERT_FALSE(certificate.at("gaps").empty());
  std::map<std::string, std::uint64_t> lost;
  for (const Json& gap : certificate.at("gaps")) {
    EXPECT_FALSE(gap.at("writer").get<std::string>().empty());
    const std::uint64_t first = gap.at("first_sequence"), last = gap.at("last_sequence");
    EXPECT_LE(first, last);
    lost[gap.at("topic")] += last - first + 1;
  }
  for (const Json& row : certificate.at("streams")) {
    if (row.at("topic") == "plant_state") {
      EXPECT_EQ(row.at("missing"), lost["plant_state"]);
    }
  }
  EXPECT_GT(lost["plant_state"], 0U);

  const Json after = certificateOf(second);
  // On a machine that is too busy for it the second file has losses too.
  const bool kept_up = after.at("gaps").empty();
  EXPECT_EQ(after.at("complete"), kept_up) << after.at("problems");
  EXPECT_NE(down.out.find(std::string("incomplete: live.mcap, an earlier recording of this run; the latest: ") +
                          (kept_up ? "complete" : "incomplete")),
            std::string::npos)
      << down.out;
  // Of a stream that the second file has losses of too, none are told as of before.
  for (const Json& row : after.at("streams")) {
    if (kept_up && row.at("topic") == "plant_state") {
      EXPECT_GE(row.value("lost_before", std::uint64_t{0}), lost["plant_state"]) << row;
    }
  }
  if (kept_up) expectVerified(bench, {second});
}

TEST(Record, WritersOfAnotherVendorAreFoundAsTheyAppear) {
  Bench bench;
  const LiveRun run(bench, restingContact());
  run.waitForStep(100);
  const std::string partition = "lab/" + run.status.at("run").get<std::string>();
  constexpr int kSamples = 50;
  const Finished foreign = runProgram(
      BATON_TEST_FOREIGN_WRITER, {std::to_string(bench.domain()), partition, std::to_string(kSamples)}, bench.folder());
  ASSERT_EQ(foreign.exit_code, 0) << foreign.err;
  const Finished down = bench.baton({"down"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;

  const mcap::Reader reader(run.recording);
  std::uint64_t contacts = 0, beacons = 0;
  reader.forEachMessage({}, [&](const mcap::MessageView& message) {
    ASSERT_NE(message.schema, nullptr);
    if (message.channel->topic == "felt_elsewhere") {
      EXPECT_EQ(message.schema->encoding, "omgidl");
      msg::Contact contact;
      ASSERT_TRUE(dds::decode(message.data, contact));
      EXPECT_EQ(contact.step(), contacts++);
    } else if (message.channel->topic == "beacon") {
      EXPECT_EQ(message.schema->name, "foreign::Beacon");
      EXPECT_EQ(message.schema->encoding, "");
      EXPECT_EQ(message.channel->metadata.at("type"), "foreign::Beacon");
      EXPECT_EQ(message.channel->metadata.at("service"), "");
      EXPECT_EQ(message.channel->metadata.at("qos"),
                "reliability: true\ndurability: false\nownership: false\nkeyed: false\n");
      ++beacons;
    }
  });
  EXPECT_EQ(contacts, static_cast<std::uint64_t>(kSamples));
  EXPECT_EQ(beacons, static_cast<std::uint64_t>(kSamples));
  const Json seen = officialReader(bench, run.recording);
  EXPECT_EQ(seen.at("topics").at("beacon").at("count"), kSamples);
  EXPECT_EQ(seen.at("topics").at("beacon").at("type"), "foreign::Beacon");
  EXPECT_EQ(seen.at("messages").get<int>() - seen.at("decoded").get<int>(), kSamples) << "all others are explained";
  const Json certificate = certificateOf(run.recording);
  EXPECT_EQ(certificate.at("complete"), true);
  bool is_vouched = false;
  for (const Json& row : certificate.at("streams")) {
    if (row.at("topic") == "beacon") is_vouched = row.at("count") == kSamples && row.at("missing") == 0;
  }
  EXPECT_TRUE(is_vouched);
  expectVerified(bench, {run.recording});
}

}  // namespace
}  // namespace baton::test
