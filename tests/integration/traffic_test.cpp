// Recording DDS traffic without a run: what any program publishes, as it was received, and what of it was lost.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>

#include "dds/endpoint.hpp"
#include "dds/interfaces.hpp"
#include "dds/typed.hpp"
#include "mcap/lookup.hpp"
#include "mcap/reader.hpp"
#include "support/file_size_limit.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;
using Bytes = std::vector<std::byte>;

/// Recognisable by its number, and not to be made smaller.
Bytes payloadOf(std::uint32_t number, std::size_t size = 64) {
  Bytes payload(size);
  std::uint32_t state = number * 2654435761U + 1;
  for (std::byte& byte : payload) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<std::byte>(state >> 24);
  }
  const std::byte header[] = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  std::memcpy(payload.data(), header, sizeof header);
  std::memcpy(payload.data() + sizeof header, &number, sizeof number);
  return payload;
}

/// `baton record traffic` in the background.
class Recorder {
 public:
  Recorder(Bench& bench, std::vector<std::string> options, const std::string& name = "traffic.mcap")
      : bench_(bench), file_(bench.folder() / name), log_(name + ".log") {
    options.insert(options.begin(),
                   {"record", "traffic", file_.string(), "--json", "--domain", std::to_string(bench.domain())});
    pid_ = bench.start("baton", options, log_);
  }
  [[nodiscard]] int pid() const { return pid_; }
  [[nodiscard]] const fs::path& file() const { return file_; }
  [[nodiscard]] std::string log() const {
    std::ostringstream text;
    text << std::ifstream(bench_.folder() / log_).rdbuf();
    return text.str();
  }
  /// What it says in the end; "exit_code" is that of the process.
  Json end(int signal = SIGINT) {
    kill(pid_, signal);
    return result();
  }
  Json result() {
    const int exit_code = bench_.wait(pid_);
    const std::string text = log();
    const std::size_t begin = text.find("\n{") == std::string::npos ? text.find('{') : text.find("\n{");
    Json json = Json::parse(begin == std::string::npos ? "" : text.substr(begin), nullptr, false);
    EXPECT_TRUE(json.is_object()) << text;
    if (!json.is_object()) return {};
    EXPECT_EQ(json.at("exit_code"), exit_code);
    return json;
  }

 private:
  Bench& bench_;
  fs::path file_;
  std::string log_;
  int pid_ = 0;
};

/// A plain program on DDS.
class Talker {
 public:
  explicit Talker(const Bench& bench, const std::string& partition = "somewhere/else")
      : participant_({.domain = bench.domain(), .partition = partition, .cell = "", .run = "", .service = "talker"}) {}

  dds::RawWriter& open(const dds::EndpointOptions& options) {
    writers_[options.topic] = std::make_unique<dds::RawWriter>(participant_, options);
    return *writers_[options.topic];
  }
  /// Opened, and matched with the recorder.
  dds::RawWriter& heard(const dds::EndpointOptions& options) {
    dds::RawWriter& writer = open(options);
    EXPECT_TRUE(eventually([&] { return !writer.matched().empty(); })) << options.topic << " has no reader";
    return writer;
  }

 private:
  dds::Participant participant_;
  std::map<std::string, std::unique_ptr<dds::RawWriter>> writers_;
};

void say(dds::RawWriter& writer, std::uint32_t count, std::size_t size = 64) {
  for (std::uint32_t i = 0; i < count; ++i) {
    ASSERT_TRUE(writer.write(payloadOf(i, size)));
    if (i % 256 == 255) (void)writer.waitForAcknowledgments(60'000);
  }
  EXPECT_TRUE(writer.waitForAcknowledgments(60'000));
}

/// All payloads by topic and type, with their sequence numbers.
struct Recorded {
  std::vector<std::uint32_t> sequences;
  std::vector<Bytes> payloads;
  mcap::StringMap metadata;
};
std::map<std::pair<std::string, std::string>, Recorded> read(const fs::path& file) {
  std::map<std::pair<std::string, std::string>, Recorded> found;
  const mcap::Reader reader(file);
  reader.forEachMessage({}, [&](const mcap::MessageView& message) {
    Recorded& to = found[{message.channel->topic, message.schema == nullptr ? "" : message.schema->name}];
    to.sequences.push_back(message.sequence);
    to.payloads.emplace_back(message.data.begin(), message.data.end());
    to.metadata = message.channel->metadata;
  });
  return found;
}

Json certificateOf(const fs::path& file) {
  const mcap::Reader reader(file);
  for (const mcap::AttachmentIndex& one : reader.attachments()) {
    if (one.name != "certificate.json") continue;
    const mcap::Bytes bytes = reader.readAttachment(one);
    return Json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  throw std::runtime_error(file.string() + " has no certificate");
}

void expectPayloads(const std::vector<Bytes>& payloads, std::uint32_t count) {
  ASSERT_EQ(payloads.size(), count);
  for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(payloads[i], payloadOf(i)) << i;
}

TEST(Traffic, EveryWriterIsRecordedAsItAppearsOfAnyTypeAndPartition) {
  Bench bench;
  Recorder recorder(bench, {"--interface", "lo"});
  Talker here(bench, "here"), there(bench, "there/and/everywhere"), pattern(bench, "p*");
  dds::RawWriter& a = here.heard({.topic = "plain/a", .type = "other::A"});
  say(a, 100);
  dds::RawWriter& b = there.heard({.topic = "plain/b", .type = "other::B", .keyed = true});
  say(b, 50);
  // Another type under a name that is taken, and a writer whose samples are older than its reader.
  dds::RawWriter& rival = pattern.heard({.topic = "plain/a", .type = "other::Rival"});
  say(rival, 10);
  dds::RawWriter& late = there.open({.topic = "late", .type = "other::A", .profile = dds::Profile::kEvent});
  for (std::uint32_t i = 0; i < 5; ++i) ASSERT_TRUE(late.write(payloadOf(i)));
  EXPECT_TRUE(eventually([&] { return !late.matched().empty(); }));
  EXPECT_TRUE(late.waitForAcknowledgments(60'000));

  const Json result = recorder.end();
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("complete"), true);
  EXPECT_EQ(result.at("ended"), "ended by Ctrl-C");
  EXPECT_EQ(result.at("messages"), 165);
  EXPECT_EQ(result.at("lost"), 0);
  auto found = read(recorder.file());
  ASSERT_EQ(found.size(), 4U);
  expectPayloads(found[{"plain/a", "other::A"}].payloads, 100);
  expectPayloads(found[{"plain/b", "other::B"}].payloads, 50);
  expectPayloads(found[{"plain/a", "other::Rival"}].payloads, 10);
  expectPayloads(found[{"late", "other::A"}].payloads, 5);
  const mcap::StringMap& of_rival = found[{"plain/a", "other::Rival"}].metadata;
  EXPECT_EQ(of_rival.at("writer"), dds::toString(rival.guid()));
  EXPECT_EQ(of_rival.at("qos"), "reliability: true\ndurability: false\nownership: false\nkeyed: false\n");
  EXPECT_NE(of_rival.at("qos_policies").find("partition: p*"), std::string::npos);

  // What can be said of it, and no more.
  const Finished verified = bench.baton({"bag", "verify", recorder.file().string()});
  EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
  EXPECT_NE(verified.out.find("as received"), std::string::npos) << verified.out;
  EXPECT_EQ(verified.out.find("proven"), std::string::npos) << verified.out;
  const Json certificate = certificateOf(recorder.file());
  EXPECT_EQ(certificate.at("run_is_over"), false);
  EXPECT_EQ(certificate.at("streams").size(), 4U);
  const Finished info = bench.baton({"bag", "info", recorder.file().string()});
  EXPECT_EQ(info.exit_code, 0) << info.out << info.err;
  EXPECT_NE(info.out.find("traffic of domain " + std::to_string(bench.domain())), std::string::npos) << info.out;
  const Finished cat = bench.baton({"bag", "cat", recorder.file().string(), "--topics", "plain/b", "--limit", "1"});
  EXPECT_EQ(cat.exit_code, 1) << "bytes in hex, as for any type without IDL" << cat.err;
  EXPECT_NE(cat.out.find("plain/b"), std::string::npos) << cat.out;
  const Finished metrics = bench.baton({"metrics", recorder.file().string()});
  EXPECT_EQ(metrics.exit_code, 2) << "it is of no run" << metrics.out << metrics.err;
}

TEST(Traffic, WhatWasRecordedIsReplayed) {
  Bench bench;
  Recorder recorder(bench, {"--interface", "lo", "--max-messages", "150"});
  Talker talker(bench);
  say(talker.heard({.topic = "first", .type = "other::A"}), 100);
  say(talker.heard({.topic = "second", .type = "other::B", .keyed = true}), 50);
  const Json result = recorder.result();
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("ended"), "--max-messages, 150, is reached");

  dds::Participant listener(
      {.domain = bench.domain(), .partition = "heard", .cell = "", .run = "", .service = "listener"});
  std::mutex mutex;
  std::map<std::string, std::vector<Bytes>> heard;
  const auto into = [&](const std::string& topic) {
    return [&, topic](const dds::RawSample& sample) {
      const std::lock_guard lock(mutex);
      heard[topic].emplace_back(sample.payload.begin(), sample.payload.end());
    };
  };
  const dds::RawReader first(listener, {.topic = "first", .type = "other::A"}, into("first"));
  const dds::RawReader second(listener, {.topic = "second", .type = "other::B", .keyed = true}, into("second"));
  const Finished replay =
      bench.baton({"replay", recorder.file().string(), "--partition", "heard", "--wait-for", "1", "--rate", "max"});
  EXPECT_EQ(replay.exit_code, 0) << replay.out << replay.err;
  EXPECT_TRUE(eventually([&] {
    const std::lock_guard lock(mutex);
    return heard["first"].size() == 100 && heard["second"].size() == 50;
  }));
  const std::lock_guard lock(mutex);
  expectPayloads(heard["first"], 100);
  expectPayloads(heard["second"], 50);
}

TEST(Traffic, WhatABestEffortWriterLosesIsCountedAndNamed) {
  Bench bench;
  Recorder recorder(bench, {"--interface", "lo"});
  setenv("BATON_LOSE_ONE_IN", "5", 1);
  Talker talker(bench);
  unsetenv("BATON_LOSE_ONE_IN");
  dds::RawWriter& sound = talker.heard({.topic = "sound", .type = "other::A"});
  dds::RawWriter& lossy = talker.heard({.topic = "motor_status", .type = "other::A", .best_effort = true});
  for (std::uint32_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(lossy.write(payloadOf(i)));
    if (i % 100 == 99) say(sound, 1);
  }
  const Json result = recorder.end(SIGTERM);
  EXPECT_EQ(result.at("exit_code"), 1) << result;
  EXPECT_EQ(result.at("complete"), false);
  EXPECT_EQ(result.at("ended"), "ended by SIGTERM");
  ASSERT_EQ(result.at("losses").size(), 1U) << result;
  EXPECT_EQ(result.at("losses").at(0).at("writer"), dds::toString(lossy.guid()));
  const Recorded of_lossy = read(recorder.file())[{"motor_status", "other::A"}];
  ASSERT_FALSE(of_lossy.sequences.empty());
  const std::uint64_t span = of_lossy.sequences.back() - of_lossy.sequences.front() + 1;
  EXPECT_EQ(result.at("losses").at(0).at("lost"), span - of_lossy.sequences.size());
  std::uint64_t in_gaps = 0;
  const Json certificate = certificateOf(recorder.file());
  for (const Json& gap : certificate.at("gaps")) {
    EXPECT_EQ(gap.at("writer"), dds::toString(lossy.guid()));
    in_gaps += gap.at("last_sequence").get<std::uint64_t>() - gap.at("first_sequence").get<std::uint64_t>() + 1;
  }
  EXPECT_EQ(in_gaps, span - of_lossy.sequences.size());
  const Finished verified = bench.baton({"bag", "verify", recorder.file().string()});
  EXPECT_EQ(verified.exit_code, 1) << verified.out;
  EXPECT_NE(verified.out.find("motor_status of " + dds::toString(lossy.guid()) + ": " +
                              std::to_string(span - of_lossy.sequences.size()) + " samples are missing"),
            std::string::npos)
      << verified.out;
}

TEST(Traffic, PatternsOfTopicsAndPartitionsChoose) {
  Bench bench;
  Recorder recorder(bench,
                    {"--interface", "lo", "--topics", "keep_*,typo", "--except", "*_not", "--partition", "here/*"});
  Recorder of_all(bench, {"--interface", "lo"}, "all.mcap");
  Talker here(bench, "here/1"), elsewhere(bench, "elsewhere");
  dds::RawWriter& left_out = here.open({.topic = "keep_not", .type = "other::A"});
  dds::RawWriter& other = here.open({.topic = "another", .type = "other::A"});
  dds::RawWriter& of_others = elsewhere.open({.topic = "keep_too", .type = "other::A"});
  dds::RawWriter& chosen = here.open({.topic = "keep_a", .type = "other::A"});
  EXPECT_TRUE(eventually([&] { return chosen.matched().size() == 2; })) << "by both";
  say(chosen, 10);
  // By then whoever wants a writer has matched it: both were told of it at the same time.
  for (dds::RawWriter* writer : {&left_out, &other, &of_others}) {
    EXPECT_TRUE(eventually([&] { return !writer->matched().empty(); })) << "by the one that records all";
    EXPECT_EQ(writer->matched().size(), 1U);
    say(*writer, 1);
  }
  const Json all = of_all.end();
  EXPECT_EQ(all.at("topics").size(), 4U) << all;
  const Json result = recorder.end(SIGHUP);
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("ended"), "ended by SIGHUP");
  ASSERT_EQ(result.at("topics").size(), 1U);
  EXPECT_EQ(result.at("topics").at(0).at("topic"), "keep_a");
  EXPECT_EQ(result.at("left_out"), Json::parse(R"(["another", "keep_not"])"));
  EXPECT_EQ(result.at("unmatched"), Json::parse(R"(["typo"])"));
  EXPECT_EQ(bench.baton({"bag", "verify", recorder.file().string()}).exit_code, 0);
}

TEST(Traffic, ASecondSignalTakesNothingAway) {
  Bench bench;
  Recorder recorder(bench, {"--interface", "lo"});
  Talker talker(bench);
  say(talker.heard({.topic = "a", .type = "other::A"}), 1000, 1000);
  kill(recorder.pid(), SIGINT);
  kill(recorder.pid(), SIGTERM);
  kill(recorder.pid(), SIGQUIT);
  const Json result = recorder.end(SIGHUP);
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("messages"), 1000);
  EXPECT_TRUE(mcap::Reader(recorder.file()).info().is_complete);
}

TEST(Traffic, OfAKilledRecorderTheFileIsReadUpToItsLastChunk) {
  Bench bench;
  Recorder recorder(bench, {"--interface", "lo", "--compression", "none"});
  Talker talker(bench);
  say(talker.heard({.topic = "a", .type = "other::A"}), 1000, 1000);
  const auto recorded = [&] { return read(recorder.file())[{"a", "other::A"}].payloads.size(); };
  EXPECT_TRUE(eventually([&] { return recorded() == 1000; })) << "in the file within a second";
  kill(recorder.pid(), SIGKILL);
  EXPECT_EQ(bench.wait(recorder.pid()), 128 + SIGKILL);
  EXPECT_EQ(recorded(), 1000U);
  EXPECT_EQ(bench.baton({"bag", "verify", recorder.file().string()}).exit_code, 1);
  const std::string sound = (bench.folder() / "sound.mcap").string();
  (void)bench.baton({"bag", "recover", recorder.file().string(), sound});
  EXPECT_TRUE(mcap::Reader(sound).info().is_complete);
}

TEST(Traffic, WhereTheFileCannotGrowItEndsAndWhatIsThereStays) {
  Bench bench;
  std::unique_ptr<Recorder> recorder;
  {
    const FileSizeLimit limit(400'000);  // which the recorder inherits
    recorder =
        std::make_unique<Recorder>(bench, std::vector<std::string>{"--interface", "lo", "--compression", "none"});
  }
  Talker talker(bench);
  say(talker.heard({.topic = "a", .type = "other::A"}), 1000, 1000);
  const Json result = recorder->result();
  EXPECT_EQ(result.at("exit_code"), 1) << result;
  EXPECT_EQ(result.at("complete"), false);
  EXPECT_NE(result.at("summary").get<std::string>().find("ended early: "), std::string::npos) << result;
  EXPECT_GT((read(recorder->file())[{"a", "other::A"}].payloads.size()), 100U);
}

TEST(Traffic, LimitsEndIt) {
  Bench bench;
  {
    Recorder recorder(bench, {"--interface", "lo", "--compression", "none", "--max-MB", "0.5", "--split-MB", "0.1"});
    Talker talker(bench);
    say(talker.heard({.topic = "a", .type = "other::A"}), 1000, 1000);
    const Json result = recorder.result();
    EXPECT_EQ(result.at("exit_code"), 0) << result;
    EXPECT_EQ(result.at("ended"), "--max-MB, 0.5, is reached");
    EXPECT_GE(result.at("files").size(), 3U);
    std::vector<std::string> verify{"bag", "verify"};
    std::uint64_t bytes = 0;
    for (const Json& file : result.at("files")) {
      verify.push_back(file);
      bytes += fs::file_size(file.get<std::string>());
    }
    EXPECT_LE(bytes, 500'000U);
    const Finished verified = bench.baton(verify);
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
  }
  Recorder recorder(bench, {"--interface", "lo", "--min-free-MB", "1e9"}, "low.mcap");
  Talker talker(bench);
  dds::RawWriter& writer = talker.heard({.topic = "a", .type = "other::A"});
  ASSERT_TRUE(writer.write(payloadOf(1)));
  const Json result = recorder.result();
  EXPECT_EQ(result.at("exit_code"), 1) << result;
  EXPECT_NE(result.at("summary").get<std::string>().find("--min-free-MB"), std::string::npos) << result;
  EXPECT_TRUE(mcap::Reader(recorder.file()).info().is_complete);
}

TEST(Traffic, EachPartBeginsWithWhatLasts) {
  Bench bench;
  Recorder recorder(bench, {"--interface", "lo", "--compression", "none", "--split-MB", "0.1"});
  Talker talker(bench);
  dds::RawWriter& map = talker.heard({.topic = "map", .type = "other::Map", .profile = dds::Profile::kEvent});
  say(map, 3);
  say(talker.heard({.topic = "a", .type = "other::A"}), 1000, 1000);
  const Json result = recorder.end(SIGQUIT);
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(result.at("ended"), "ended by Ctrl-\\");
  EXPECT_EQ(result.at("messages"), 1003) << "what is repeated does not count";
  ASSERT_GE(result.at("files").size(), 3U);
  std::vector<std::string> verify{"bag", "verify"};
  for (const Json& file : result.at("files")) {
    verify.push_back(file);
    const std::vector<Bytes> payloads = read(file.get<std::string>())[{"map", "other::Map"}].payloads;
    ASSERT_FALSE(payloads.empty()) << file;
    EXPECT_EQ(payloads.back(), payloadOf(2)) << file;
  }
  const Finished verified = bench.baton(verify);
  EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
}

TEST(Traffic, WhatIsWrongIsSaidAtOnce) {
  Bench bench;
  const std::string there = bench.write("there.mcap", "precious");
  const Finished exists = bench.baton({"record", "traffic", there});
  EXPECT_EQ(exists.exit_code, 3) << exists.err;
  EXPECT_NE(exists.err.find("--overwrite"), std::string::npos) << exists.err;
  EXPECT_EQ(fs::file_size(there), 8U);
  const std::string file = (bench.folder() / "new.mcap").string();
  const Finished interface = bench.baton({"record", "traffic", file, "--interface", "nowhere0"});
  EXPECT_EQ(interface.exit_code, 2) << interface.err;
  EXPECT_NE(interface.err.find("expected all or one of "), std::string::npos) << interface.err;
  EXPECT_NE(interface.err.find("lo (127.0.0.1)"), std::string::npos) << interface.err;
  EXPECT_FALSE(fs::exists(file));
  const Finished spared = bench.baton({"record", "traffic", there, "--overwrite", "--interface", "nowhere0"});
  EXPECT_EQ(spared.exit_code, 2) << spared.err;
  EXPECT_EQ(fs::file_size(there), 8U) << "it is replaced only when all else is in order";
  // An empty recording is no success.
  const Finished nothing =
      bench.baton({"record", "traffic", file, "--interface", "lo", "--topics", "nothing_*", "--duration", "0.1"});
  EXPECT_EQ(nothing.exit_code, 1) << nothing.out << nothing.err;
  EXPECT_NE(nothing.out.find("nothing came: expected writers in domain"), std::string::npos) << nothing.out;
  const Finished replaced = bench.baton(
      {"record", "traffic", file, "--interface", "lo", "--topics", "nothing_*", "--duration", "0.1", "--overwrite"});
  EXPECT_EQ(replaced.exit_code, 1) << replaced.out << replaced.err;
}

TEST(Traffic, ARunThatIsRecordedFromOutsideIsTheSameRun) {
  Bench bench;
  const auto hashOf = [&](const std::string& name, const std::string& extra) {
    const std::string out = (bench.folder() / name).string(), scenario = bench.write("short.yaml", shortContact(extra));
    const Json run = bench.batonJson({"run", scenario, "--out", out, "--json"});
    EXPECT_EQ(run.at("exit_code"), 0) << run;
    EXPECT_EQ(run.at("recording").at("complete"), true);
    return run.at("chain_hash");
  };
  const Json alone = hashOf("alone.mcap", "");
  Recorder recorder(bench, {"--interface", "lo"});
  EXPECT_TRUE(eventually([&] { return fs::exists(recorder.file()); }));
  EXPECT_EQ(hashOf("watched.mcap", "rate: 0.5\n"), alone);  // it does not wait until it is watched
  const Json result = recorder.end();
  EXPECT_GT(result.at("messages"), kShortSteps) << result;
  const Finished verified = bench.baton({"bag", "verify", recorder.file().string()});
  EXPECT_EQ(verified.out.find("vouch for"), std::string::npos) << verified.out;
  EXPECT_EQ(verified.out.find("proven"), std::string::npos) << verified.out;
}

TEST(Traffic, OfARunUnderWayTheLoopIsRecordedFromWhereItIs) {
  Bench bench;
  const LiveRun run(bench, endlessContact("rate: 0.1\n"));  // what is remembered for the recorder lasts for 5 s
  run.waitForStep(200);
  Recorder recorder(bench, {"--interface", "lo", "--topics", "plant_state,reference"});
  ASSERT_TRUE(eventually([&] {
    const std::string log = recorder.log();
    return log.find("topic=plant_state") != std::string::npos && log.find("topic=reference") != std::string::npos;
  }));
  run.waitForStep(bench.batonJson({"status", "--json"}).at("step").get<std::uint64_t>() + 200);
  const Json result = recorder.end();
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  const mcap::Reader reader(recorder.file());
  EXPECT_EQ(mcap::topicNames(reader), (std::vector<std::string>{"plant_state", "reference"}));
  const auto streams = readStreams(recorder.file().string());
  const auto states = decodeStream<msg::PlantState>(streams.at({"plant_state", "plant"}));
  ASSERT_FALSE(states.empty());
  EXPECT_GE(states.front().step(), 200U);
  for (std::size_t i = 1; i < states.size(); ++i) EXPECT_EQ(states[i].step(), states[i - 1].step() + 1) << i;
}

TEST(Traffic, AnotherVendorsTalkerInItsDefaultConfigurationIsRecordedByDefault) {
  const auto there = dds::interfaces();
  if (std::ranges::all_of(there, [](const dds::Interface& one) { return one.name == "lo"; })) {
    GTEST_SKIP() << "this machine has the loopback alone, on which that product does not use multicast";
  }
  Bench bench;
  constexpr std::uint32_t kSamples = 50;
  Recorder recorder(bench, {"--topics", "talk_*"});
  const Finished talker =
      runProgram(BATON_TEST_FOREIGN_TALKER, {std::to_string(bench.domain()), std::to_string(kSamples)}, bench.folder());
  ASSERT_EQ(talker.exit_code, 0) << talker.err;
  const Json result = recorder.end();
  EXPECT_EQ(result.at("lost"), 0) << result;
  auto found = read(recorder.file());
  EXPECT_EQ((found[{"talk_beacons", "foreign::Beacon"}].payloads.size()), kSamples);
  EXPECT_EQ((found[{"talk_status", "foreign::Beacon"}].payloads.size()), kSamples);
  // Keyed and lasting: the latest of each sensor from before, without the four that were replaced; then two more, with
  // the number of what was disposed of between them.
  const Recorded& readings = found[{"talk_readings", "foreign::Reading"}];
  EXPECT_EQ(readings.sequences, (std::vector<std::uint32_t>{1, 6, 7, 9}));
  EXPECT_EQ(mcap::valueOf(readings.metadata, "qos"),
            "reliability: true\ndurability: true\nownership: false\nkeyed: true\n");
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  const Finished verified = bench.baton({"bag", "verify", recorder.file().string()});
  EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
  const Finished replay = bench.baton({"replay", recorder.file().string(), "--rate", "max", "--interface", "all"});
  EXPECT_EQ(replay.exit_code, 0) << replay.out << replay.err;
}

}  // namespace
}  // namespace baton::test
