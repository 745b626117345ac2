// A replay that is controlled from elsewhere, by keys, and by who listens. It plays numbers, so that whatever arrives
// says where in the recording it comes from.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <future>
#include <mutex>
#include <numeric>

#include "dds/typed.hpp"
#include "mcap/writer.hpp"
#include "runtime/paths.hpp"
#include "support/on_terminal.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr std::uint64_t kMs = 1'000'000;

using Numbers = std::vector<std::uint32_t>;

Numbers range(std::uint32_t begin, std::uint32_t end) {
  Numbers numbers(end - begin);
  std::iota(numbers.begin(), numbers.end(), begin);
  return numbers;
}

mcap::Bytes payloadOf(std::uint32_t number) {
  mcap::Bytes payload{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  payload.resize(8);
  std::memcpy(payload.data() + 4, &number, sizeof number);
  return payload;
}

/// 0, 1, 2, ... on the topic "numbers", `spacing_ns` apart; behind every tenth one message more on "tens".
std::string writeNumbers(const Bench& bench, std::uint32_t count, std::uint64_t spacing_ns = kMs) {
  std::string file = (bench.folder() / "numbers.mcap").string();
  mcap::WriterOptions options;
  options.chunk_bytes = 4096;  // a seek has many to choose from
  mcap::Writer writer(file, options);
  const mcap::SchemaId schema = writer.addSchema("baton::test::Number", "omgidl", {});
  const mcap::StringMap metadata{{"qos", "reliability: reliable\ndurability: volatile\n"}};
  const mcap::ChannelId numbers = writer.addChannel("numbers", "cdr", schema, metadata);
  const mcap::ChannelId tens = writer.addChannel("tens", "cdr", schema, metadata);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t time_ns = kStart_ns + i * spacing_ns;
    writer.write(numbers, i + 1, time_ns, time_ns - 100, payloadOf(i));
    if (i % 10 == 9) writer.write(tens, i / 10 + 1, time_ns, time_ns - 50, payloadOf(i));
  }
  writer.close();
  return file;
}

/// Hears one topic of the replay.
class Listener {
 public:
  Listener(const Bench& bench, const std::string& service, const std::string& partition = "replay/test",
           const std::string& topic = "numbers")
      : participant_(
            {.domain = bench.domain(), .partition = partition, .cell = "replay", .run = "test", .service = service}),
        reader_(participant_, {.topic = topic, .type = "baton::test::Number"}, [this](const dds::RawSample& sample) {
          std::uint32_t number = 0;
          std::memcpy(&number, sample.payload.data() + 4, sizeof number);
          const std::lock_guard lock(mutex_);
          numbers_.push_back(number);
          source_ns_.push_back(sample.source_timestamp_ns);
        }) {}
  [[nodiscard]] Numbers numbers() const {
    const std::lock_guard lock(mutex_);
    return numbers_;
  }
  [[nodiscard]] std::vector<std::int64_t> sourceTimes() const {
    const std::lock_guard lock(mutex_);
    return source_ns_;
  }
  [[nodiscard]] bool hears(const Numbers& expected) const {
    return eventually([&] { return numbers().size() >= expected.size(); }) && numbers() == expected;
  }

 private:
  mutable std::mutex mutex_;
  Numbers numbers_;
  std::vector<std::int64_t> source_ns_;
  dds::Participant participant_;
  dds::RawReader reader_;
};

class ReplayControl : public testing::Test {
 protected:
  void start(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--run", "test", "--domain", std::to_string(bench_.domain()), "--json"});
    pid_ = bench_.start("baton-replayer", arguments, "replay.log");
  }
  /// Says something to the replay, which must be done, and returns the answer.
  nlohmann::json player(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "player");
    arguments.emplace_back("--json");
    const Finished finished = bench_.baton(arguments);
    EXPECT_EQ(finished.exit_code, 0) << arguments.at(1) << ": " << finished.out << finished.err;
    return nlohmann::json::parse(finished.out);
  }
  [[nodiscard]] bool stands(const std::string& state) {
    return eventually([&] {  // it may take its time to appear
      const Finished status = bench_.baton({"player", "status", "--json"});
      return status.exit_code == 0 && nlohmann::json::parse(status.out).at("state") == state;
    });
  }
  Bench bench_;
  int pid_ = 0;
};

TEST_F(ReplayControl, StepsExactlySoManyAndAPauseHolds) {
  Listener listener(bench_, "listener");
  start({writeNumbers(bench_, 60'000), "--paused", "--wait-for-readers", "listener"});
  ASSERT_TRUE(stands("paused"));
  EXPECT_EQ(player({"step"}).at("messages"), 1);
  EXPECT_EQ(player({"step", "5"}).at("messages"), 6);
  EXPECT_TRUE(listener.hears(range(0, 6)));
  // Two messages on "tens": behind 9 and behind 19.
  EXPECT_EQ(player({"step", "2", "--topic", "tens"}).at("messages"), 22);
  EXPECT_TRUE(listener.hears(range(0, 20)));
  const Finished misspelt = bench_.baton({"player", "step", "--topic", "number"});
  EXPECT_EQ(misspelt.exit_code, 1);
  EXPECT_NE(misspelt.out.find("found number; did you mean 'numbers'?"), std::string::npos) << misspelt.out;

  player({"resume"});
  ASSERT_TRUE(eventually([&] { return listener.numbers().size() > 100; }));
  const nlohmann::json paused = player({"pause"});
  const auto messages = paused.at("messages").get<std::uint32_t>();
  const std::uint32_t numbers = messages - messages / 11;  // each ten of them has one more message behind it
  EXPECT_TRUE(listener.hears(range(0, numbers)));
  for (int i = 0; i < 3; ++i) {
    const nlohmann::json status = player({"status"});
    EXPECT_EQ(status.at("state"), "paused");
    EXPECT_EQ(status.at("messages"), messages);
    EXPECT_EQ(status.at("position_s"), paused.at("position_s"));
  }
  EXPECT_EQ(listener.numbers().size(), numbers);

  player({"stop"});
  EXPECT_EQ(bench_.wait(pid_), 0);
  EXPECT_EQ(listener.numbers().size(), numbers);
}

TEST_F(ReplayControl, TheNameOfARunLeadsToNoOtherFolder) {
  const std::string file = writeNumbers(bench_, 10);
  for (const char* wrong : {"../a", "a/b", ".a"}) {
    const Finished refused = bench_.baton({"replay", file, "--run", wrong});
    EXPECT_EQ(refused.exit_code, 2) << refused.out;
    EXPECT_NE(refused.err.find(wrong), std::string::npos) << refused.err;
  }
}

TEST_F(ReplayControl, ObeysItsUserAlone) {
  start({writeNumbers(bench_, 1000), "--paused"});
  ASSERT_TRUE(stands("paused"));
  dds::Participant stranger({.domain = bench_.domain(),
                             .partition = "replay/test",
                             .cell = "replay",
                             .run = "test",
                             .service = "operator-1"});
  dds::Writer<msg::ReplayRequest> writer(stranger, dds::topics::kReplayRequest);
  ASSERT_TRUE(eventually([&] { return !writer.raw().matched().empty(); }));
  msg::ReplayRequest request;
  request.action(msg::REPLAY_STOP);
  writer.write(request);
  ASSERT_TRUE(eventually(
      [&] { return readFile(bench_.folder() / "replay.log").find("a stranger writes") != std::string::npos; }));
  EXPECT_EQ(player({"step", "3"}).at("messages"), 3);
  const std::filesystem::path key = bench_.folder() / "replays" / std::to_string(bench_.domain()) / "replay/test/key";
  EXPECT_EQ(std::filesystem::status(key).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);

  std::filesystem::rename(key, bench_.folder() / "key");  // as for another user, who cannot read it
  const Finished refused = bench_.baton({"player", "stop"});
  EXPECT_EQ(refused.exit_code, 3) << refused.out;
  EXPECT_NE(refused.err.find("takes requests from the user who started it"), std::string::npos) << refused.err;
  std::filesystem::rename(bench_.folder() / "key", key);

  player({"stop"});
  EXPECT_EQ(bench_.wait(pid_), 0);
  EXPECT_FALSE(std::filesystem::exists(key.parent_path()));
}

/// Any process can say that it is a replay, of this name or another one, and what a replay says.
TEST_F(ReplayControl, WhoOnlyClaimsToBeAReplayIsNone) {
  start({writeNumbers(bench_, 1000), "--paused"});
  ASSERT_TRUE(stands("paused"));
  const auto claimed = [&](const std::string& run) {
    return dds::ParticipantOptions{
        .domain = bench_.domain(), .partition = "replay/" + run, .cell = "replay", .run = run, .service = "replayer"};
  };
  dds::Participant same(claimed("test")), another(claimed("another"));
  dds::Writer<msg::ReplayStatus> liar(same, dds::topics::kReplayStatus), stage(another, dds::topics::kReplayStatus);
  msg::ReplayStatus status;
  status.state(msg::REPLAY_FINISHED);
  status.path("\x1b[2J");
  liar.write(status);
  status.state(msg::REPLAY_PLAYING);
  stage.write(status);
  const nlohmann::json told = player({"status"});
  EXPECT_EQ(told.at("run"), "test") << told;
  EXPECT_EQ(told.at("state"), "paused") << told;
  EXPECT_EQ(player({"step", "3"}).at("messages"), 3);
  const Finished theirs = bench_.baton({"player", "status", "--run", "another"});
  EXPECT_EQ(theirs.exit_code, 0) << "a replay without a key can be looked at: " << theirs.err;
  EXPECT_EQ(theirs.out.find('\x1b'), std::string::npos) << theirs.out;
  EXPECT_EQ(bench_.baton({"player", "stop", "--run", "another"}).exit_code, 3);
  player({"stop"});
  EXPECT_EQ(bench_.wait(pid_), 0);
}

TEST_F(ReplayControl, SeeksWhereItIsToldBothWays) {
  Listener listener(bench_, "listener");
  start({writeNumbers(bench_, 20'000), "--paused", "--wait-for-readers", "listener", "--from", "1"});
  ASSERT_TRUE(stands("paused"));
  EXPECT_DOUBLE_EQ(player({"seek", "15.5"}).at("position_s").get<double>(), 15.5);
  player({"step", "2"});
  player({"seek", "1.25"});
  player({"step"});
  player({"seek", "3.0001"});  // between two messages: the next one
  player({"step"});
  EXPECT_TRUE(listener.hears({15'500, 15'501, 1250, 3001}));

  const Finished beyond = bench_.baton({"player", "seek", "0.5"});  // in front of --from
  EXPECT_EQ(beyond.exit_code, 1) << beyond.out << beyond.err;
  EXPECT_NE(beyond.out.find("expected 1 to 19.999 s, found 0.5"), std::string::npos) << beyond.out;

  // At the end it stays, and a step that finds too little says so.
  player({"seek", "19.998"});
  const Finished cut = bench_.baton({"player", "step", "100"});
  EXPECT_EQ(cut.exit_code, 1) << cut.out << cut.err;
  EXPECT_NE(cut.out.find("3 of 100 were sent"), std::string::npos) << cut.out;
  EXPECT_EQ(player({"status"}).at("state"), "paused");
  player({"resume"});
  EXPECT_EQ(bench_.wait(pid_), 0);
  EXPECT_TRUE(listener.hears({15'500, 15'501, 1250, 3001, 19'998, 19'999}));
}

TEST_F(ReplayControl, AGapIsSkippedWhenAsked) {
  Listener listener(bench_, "listener");
  // An hour between two messages: nothing ends unless the gaps are skipped.
  start({writeNumbers(bench_, 20, 3'600'000 * kMs), "--wait-for-readers", "listener", "--skip-gaps", "0.001"});
  EXPECT_EQ(bench_.wait(pid_), 0);
  EXPECT_TRUE(listener.hears(range(0, 20)));
}

TEST_F(ReplayControl, AGapIsSkippedAfterASeekIntoItToo) {
  Listener listener(bench_, "listener");
  start({writeNumbers(bench_, 20, 3'600'000 * kMs), "--paused", "--wait-for-readers", "listener", "--skip-gaps",
         "0.001"});
  ASSERT_TRUE(stands("paused"));
  player({"seek", "5400"});  // half an hour before the third
  player({"resume"});
  EXPECT_EQ(bench_.wait(pid_), 0);
  EXPECT_TRUE(listener.hears(range(2, 20)));
}

TEST_F(ReplayControl, ATopicThatCannotBeReplayedIsLeftOutAndTheOthersAreReplayed) {
  const std::string file = (bench_.folder() / "bad.mcap").string();
  mcap::Writer writer(file, {});
  std::uint64_t time_ns = kStart_ns;
  const auto add = [&](const std::string& topic, const std::string& type, const std::string& encoding = "cdr",
                       const std::string& qos = "reliability: reliable\ndurability: volatile\n") {
    const mcap::ChannelId channel =
        writer.addChannel(topic, encoding, writer.addSchema(type, "omgidl", {}), {{"qos", qos}});
    for (std::uint32_t i = 0; i < 5; ++i) {
      time_ns += kMs;
      writer.write(channel, i + 1, time_ns, time_ns, payloadOf(i));
    }
  };
  add("two", "One");
  add("numbers", "baton::test::Number");
  add("two", "Another");
  add("text", "Json", "json");
  add("long", std::string(300, 'T'));
  add("contradicting", "baton::test::Number", "cdr",
      "reliability: best_effort\ndurability: volatile\nownership: exclusive\n");
  writer.close();

  const std::vector<std::string> replay{"replay", file, "--rate", "max", "--json"};
  const Finished all = bench_.baton(replay);
  EXPECT_EQ(all.exit_code, 1) << all.err;
  const nlohmann::json summary = nlohmann::json::parse(all.out);
  const auto problems = summary.at("problems").get<std::vector<std::string>>();
  const auto isNamed = [&](const std::string& topic) {
    return std::count_if(problems.begin(), problems.end(), [&](const std::string& problem) {
      return problem.find("topic " + topic) != std::string::npos && problem.find("--topics") != std::string::npos;
    });
  };
  for (const char* topic : {"two", "text", "long"}) EXPECT_EQ(isNamed(topic), 1) << topic << summary;
  EXPECT_EQ(isNamed("numbers"), 0);
  // Whether exclusive writers may be best effort is for the DDS to say.
  EXPECT_EQ(summary.at("messages"), isNamed("contradicting") > 0 ? 5 : 10) << summary;

  std::vector<std::string> chosen = replay;
  chosen.insert(chosen.end(), {"--topics", "numbers"});
  EXPECT_EQ(bench_.baton(chosen).exit_code, 0);
  chosen.back() = "two";
  const Finished none = bench_.baton(chosen);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("expected one type, found One and Another"), std::string::npos) << none.err;
}

/// It takes its first message, and from then on acknowledges none: the thread that would stands there.
class DeafListener {
 public:
  DeafListener(const Bench& bench, const std::string& service)
      : participant_({.domain = bench.domain(),
                      .partition = "replay/test",
                      .cell = "replay",
                      .run = "test",
                      .service = service}) {
    const std::shared_future<void> over = over_.get_future().share();
    for (const char* topic : {"numbers", "tens"}) {
      readers_.push_back(std::make_unique<dds::RawReader>(
          participant_, dds::EndpointOptions{.topic = topic, .type = "baton::test::Number"},
          [this, over](const dds::RawSample&) { is_deaf_ = true, over.wait(); }));
    }
  }
  ~DeafListener() { over_.set_value(); }
  [[nodiscard]] bool isDeaf() const { return is_deaf_; }

 private:
  std::promise<void> over_;
  std::atomic<bool> is_deaf_{false};
  dds::Participant participant_;
  std::vector<std::unique_ptr<dds::RawReader>> readers_;
};

TEST_F(ReplayControl, AReaderNobodyAskedForIsWaitedForOnceAndCostsNoVerdict) {
  const DeafListener deaf(bench_, "deaf");
  start({writeNumbers(bench_, 3000), "--paused"});
  ASSERT_TRUE(stands("paused"));
  ASSERT_TRUE(eventually([&] { return player({"step"}).at("messages") > 0 && deaf.isDeaf(); }));
  player({"resume"});
  EXPECT_EQ(bench_.wait(pid_), 0);
  EXPECT_NE(readFile(bench_.folder() / "replay.log").find("does not acknowledge: it is no"), std::string::npos);
}

TEST_F(ReplayControl, AReaderThatWasAskedForHasToAcknowledge) {
  const DeafListener deaf(bench_, "deaf");
  start({writeNumbers(bench_, 20), "--wait-for-readers", "deaf"});
  EXPECT_EQ(bench_.wait(pid_), 1);
}

TEST_F(ReplayControl, AChangeOfRateTakesEffect) {
  Listener listener(bench_, "listener");
  // An hour between two messages: nothing ends unless the rate is obeyed.
  start({writeNumbers(bench_, 20, 3'600'000 * kMs), "--wait-for-readers", "listener"});
  ASSERT_TRUE(listener.hears({0}));
  player({"rate", "1e8"});
  EXPECT_TRUE(listener.hears(range(0, 20)));
  EXPECT_EQ(bench_.wait(pid_), 0);
}

TEST_F(ReplayControl, ARateOfMaxWaitsForNoTime) {
  Listener listener(bench_, "listener");
  start({writeNumbers(bench_, 20, 3'600'000 * kMs), "--wait-for-readers", "listener"});
  ASSERT_TRUE(listener.hears({0}));
  player({"rate", "max"});
  EXPECT_TRUE(listener.hears(range(0, 20)));
  EXPECT_EQ(bench_.wait(pid_), 0);
}

TEST_F(ReplayControl, ALoopRepeatsBytesAndSourceTimes) {
  Listener listener(bench_, "listener");
  const std::string file = writeNumbers(bench_, 300);
  const nlohmann::json result = bench_.batonJson(
      {"replay", file, "--loop", "3", "--rate", "max", "--wait-for-readers", "listener", "--run", "test", "--json"});
  EXPECT_EQ(result.at("passes"), 3);
  EXPECT_EQ(result.at("messages"), 990);
  EXPECT_EQ(result.at("total"), 330);
  Numbers expected;
  std::vector<std::int64_t> expected_ns;
  for (int pass = 0; pass < 3; ++pass) {
    for (std::uint32_t i = 0; i < 300; ++i) {
      expected.push_back(i);
      expected_ns.push_back(static_cast<std::int64_t>(kStart_ns + i * kMs - 100));
    }
  }
  EXPECT_TRUE(listener.hears(expected));
  const std::vector<std::int64_t> times_ns = listener.sourceTimes();
  ASSERT_EQ(times_ns.size(), expected_ns.size());
  for (std::size_t i = 0; i < times_ns.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(times_ns[i] - expected_ns[i]), 0.0, 1.0) << i;  // RTPS counts 2^-32 s
  }
}

TEST_F(ReplayControl, WaitsForReadersByTheirNames) {
  start({writeNumbers(bench_, 50), "--wait-for-readers", "watcher,listener", "--rate", "max"});
  Listener listener(bench_, "listener");
  ASSERT_TRUE(stands("waiting"));
  ASSERT_TRUE(eventually([&] { return player({"status"}).at("waiting_for") == "watcher to read a topic"; }));
  const Finished step = bench_.baton({"player", "step"});
  EXPECT_EQ(step.exit_code, 1) << step.out;
  EXPECT_NE(step.out.find("it waits for watcher"), std::string::npos) << step.out;
  EXPECT_TRUE(listener.numbers().empty());
  Listener watcher(bench_, "watcher", "replay/test", "tens");
  EXPECT_TRUE(listener.hears(range(0, 50)));
  EXPECT_TRUE(watcher.hears({9, 19, 29, 39, 49}));
  EXPECT_EQ(bench_.wait(pid_), 0);
}

TEST_F(ReplayControl, IsHeardInAnotherPartitionAsWell) {
  Listener anywhere(bench_, "anywhere", "");
  Listener listener(bench_, "listener");
  Listener stranger(bench_, "stranger", "elsewhere");
  const Finished replay = bench_.baton({"replay", writeNumbers(bench_, 50), "--partition", "", "--rate", "max",
                                        "--wait-for-readers", "anywhere,listener", "--run", "test"});
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_TRUE(anywhere.hears(range(0, 50)));
  EXPECT_TRUE(listener.hears(range(0, 50)));
  EXPECT_TRUE(stranger.numbers().empty());
}

TEST_F(ReplayControl, AReplayThatIsGoneIsAClearError) {
  const auto expectNobody = [&] {
    const Finished finished = bench_.baton({"player", "pause"});
    EXPECT_EQ(finished.exit_code, 3) << finished.out << finished.err;
    EXPECT_NE(finished.err.find("nothing is replayed in cell replay of domain"), std::string::npos) << finished.err;
  };
  start({writeNumbers(bench_, 50), "--paused"});
  ASSERT_TRUE(stands("paused"));
  kill(pid_, SIGKILL);
  EXPECT_EQ(bench_.wait(pid_), 128 + SIGKILL);
  expectNobody();
}

TEST_F(ReplayControl, OfTwoReplaysOneMustBeNamed) {
  const std::string file = writeNumbers(bench_, 50);
  start({file, "--paused"});
  ASSERT_TRUE(stands("paused"));
  const int other = bench_.start(
      "baton-replayer", {file, "--paused", "--run", "other", "--domain", std::to_string(bench_.domain())}, "other.log");
  ASSERT_TRUE(eventually([&] { return bench_.baton({"player", "status", "--run", "other"}).exit_code == 0; }));
  ASSERT_TRUE(eventually([&] { return bench_.baton({"player", "status"}).exit_code == 2; }));
  player({"stop", "--run", "other"});
  EXPECT_EQ(bench_.wait(other), 0);
  EXPECT_TRUE(stands("paused")) << "the first one goes on";
}

TEST_F(ReplayControl, AMessageLaterThanAllowedIsAFailure) {
  const std::string file = writeNumbers(bench_, 50);
  const Finished late = bench_.baton({"replay", file, "--max-late-us", "0", "--overdue-us", "0", "--json"});
  EXPECT_EQ(late.exit_code, 1) << late.out << late.err;  // nothing is sent in no time
  EXPECT_EQ(nlohmann::json::parse(late.out).at("overdue"), 55);
  EXPECT_EQ(bench_.baton({"replay", file, "--max-late-us", "1e9"}).exit_code, 0);
}

TEST_F(ReplayControl, ObeysKeysAndGivesTheTerminalBack) {
  Listener listener(bench_, "listener");
  const std::vector<std::string> arguments{
      writeNumbers(bench_, 60'000),   "--paused", "--wait-for-readers", "listener", "--run", "test", "--domain",
      std::to_string(bench_.domain())};
  {
    OnTerminal replay(bench_, arguments);
    ASSERT_TRUE(eventually([&] { return !replay.isAsFound(); }));
    ASSERT_TRUE(stands("paused"));
    replay.strike("\033[C\033[C");
    EXPECT_TRUE(listener.hears({0, 1}));
    replay.strike("+");
    EXPECT_TRUE(eventually([&] { return player({"status"}).at("rate") == 2.0; }));
    replay.strike(" ");
    EXPECT_TRUE(eventually([&] { return listener.numbers().size() > 100; }));
    replay.strike(" ");
    EXPECT_TRUE(stands("paused"));
    const double before_s = player({"status"}).at("position_s");
    replay.strike("\033[D");
    EXPECT_TRUE(eventually([&] {
      return std::abs(player({"status"}).at("position_s").get<double>() - std::max(0.0, before_s - 1.0)) < 1e-6;
    }));
    replay.signal(SIGTSTP);  // Ctrl-Z
    EXPECT_TRUE(eventually([&] { return replay.isStopped(); }));
    EXPECT_TRUE(replay.isAsFound());
    replay.signal(SIGCONT);  // fg
    EXPECT_TRUE(eventually([&] { return !replay.isAsFound(); }));
    replay.strike("q");
    EXPECT_EQ(replay.exitCode(), 0);
    EXPECT_TRUE(replay.isAsFound());
  }
  OnTerminal replay(bench_, arguments);
  ASSERT_TRUE(eventually([&] { return !replay.isAsFound(); }));
  replay.strike("\003");  // Ctrl-C
  EXPECT_EQ(replay.exitCode(), 130);
  EXPECT_TRUE(replay.isAsFound());
}

}  // namespace
}  // namespace baton::test
