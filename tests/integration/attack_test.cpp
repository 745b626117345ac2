// What any user of the machine can do to another user's run over DDS without forging RTPS: the run reports it, and
// neither the bytes of the loop, nor the exit code, nor the recording's verdict change.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>

#include "mcap/lookup.hpp"
#include "mcap/reader.hpp"
#include "runtime/admission.hpp"
#include "runtime/paths.hpp"
#include "runtime/service_options.hpp"
#include "support/attacks.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

/// Strangers that answer every state of one run, each under the name of the service it pretends to be.
class Strangers {
 public:
  /// @param choose  which attacks follow a state.  @param key  of the run: with it they are no strangers.
  Strangers(const LiveRun& run, std::span<const Attack> attacks, std::function<std::vector<std::size_t>()> choose,
            const std::optional<dds::RunKey>& key = {})
      : run_(run), attacks_(attacks), choose_(std::move(choose)) {
    const std::string id = run.status.at("run");
    for (const Attack& attack : attacks) {
      by_claim_.try_emplace(attack.claims, run.bench.domain(), id, attack.claims, "", key);
    }
    eyes_ = std::make_unique<dds::Reader<msg::PlantState>>(
        by_claim_.begin()->second.participant(), dds::topics::kPlantState,
        [this](const msg::PlantState& state, const dds::RawSample& sample) {
          if (!isOurs(sample)) attack(state, choose_());
        });
  }
  /// Makes all writers and waits until each stranger has a reader in the run.
  [[nodiscard]] bool areHeard() {
    std::vector<std::size_t> all(attacks_.size());
    std::iota(all.begin(), all.end(), 0);
    return eventually([&] {
      attack({}, all);
      return !eyes_->raw().matched().empty() &&
             std::ranges::all_of(by_claim_, [](const auto& one) { return one.second.isHeard(); });
    });
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }

 private:
  [[nodiscard]] bool isOurs(const dds::RawSample& sample) const {
    return std::ranges::any_of(by_claim_, [&](const auto& one) { return one.second.hasWritten(sample); });
  }
  void attack(const msg::PlantState& state, const std::vector<std::size_t>& chosen) {
    const std::lock_guard lock(mutex_);
    // A state that one of them writes comes here within write(), and with it a state of the plant that has waited.
    if (is_over_ || is_attacking_) return;
    is_attacking_ = true;
    for (const std::size_t i : chosen) attacks_[i].say(by_claim_.at(attacks_[i].claims), state, run_);
    is_attacking_ = false;
  }

  const LiveRun& run_;
  std::span<const Attack> attacks_;
  std::function<std::vector<std::size_t>()> choose_;
  std::recursive_mutex mutex_;
  bool is_over_ = false;
  bool is_attacking_ = false;
  std::map<std::string, Stranger> by_claim_;
  std::unique_ptr<dds::Reader<msg::PlantState>> eyes_;
};

struct Mode {
  const char* name;
  std::string scenario;
  std::vector<std::string> options = {};
  bool is_lockstep = true;
};

/// A run of the scenario in lockstep that nobody attacks.
struct Alone {
  explicit Alone(const std::string& scenario) {
    const nlohmann::json result =
        bench.batonJson({"run", bench.write("alone.yaml", scenario), "--out", recording(), "--json"});
    hash = result.at("chain_hash");
  }
  [[nodiscard]] std::string recording() const { return (bench.folder() / "alone.mcap").string(); }
  Bench bench;
  std::string hash;
};

/// All bytes of the loop in lockstep. In real time a missed step has other bytes; the arm, which is at rest, is where
/// it was all the same.
void expectTheSameLoop(const Alone& alone, const LiveRun& run, const nlohmann::json& result, bool is_lockstep) {
  if (is_lockstep) {
    EXPECT_EQ(result.at("chain_hash"), alone.hash);
  } else {
    const Finished diff = run.bench.baton(
        {"bag", "diff", alone.recording(), run.recording, "--topics", "plant_state", "--tolerance", "1e-6"});
    EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
  }
}

/// Whether a service has told of an attack, by its log.
std::function<bool(const Attack&)> isTold(const LiveRun& run) {
  std::string logs;
  for (const auto& entry : std::filesystem::directory_iterator(run.folder())) {
    if (entry.path().extension() == ".log") logs += readFile(entry.path());
  }
  return [logs](const Attack& attack) { return logs.find(attack.told) != std::string::npos; };
}

void expectUndisturbed(const Mode& mode, const Alone& alone, std::span<const Attack> attacks,
                       std::function<std::vector<std::size_t>()> choose) {
  const Bench bench;
  std::vector<std::string> options = mode.options;
  options.emplace_back("--paused");
  const LiveRun run(bench, mode.scenario, options);
  Strangers strangers(run, attacks, std::move(choose));
  ASSERT_TRUE(eventually([&] { return strangers.areHeard() && std::ranges::all_of(attacks, isTold(run)); }));
  ASSERT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  const nlohmann::json result = run.result();
  strangers.stop();
  EXPECT_EQ(result.at("state"), "finished") << result;
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
  expectTheSameLoop(alone, run, result, mode.is_lockstep);
  EXPECT_EQ(bench.baton({"bag", "verify", run.recording}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(bench.folder() / "authorized_keys"));
  for (const std::string& topic : mcap::topicNames(mcap::Reader(run.recording))) {
    EXPECT_TRUE(dds::topics::called(topic) || topic.starts_with("their_")) << topic << " is of a stranger";
  }
  // In the logs: what the recorder tells, who alone reads some topics, is not in what it records.
  for (const Attack& attack : attacks) EXPECT_TRUE(isTold(run)(attack)) << attack.name << " is not told";
}

/// Its robot's path is relative to where it lies.
std::string demoScenario() {
  std::string text = readFile(deployFolder() / "scenarios/demo.yaml");
  const std::string relative = "../robots/";
  text.replace(text.find(relative), relative.size(), (deployFolder() / "robots/").string());
  return text;
}

/// In real time the arm is at rest, and nothing is planned that a busy machine could make late: commands that are
/// hundreds of steps old hold it there, and drive a moving arm out of its way.
const Mode kModes[] = {
    {"lockstep", shortContact("rate: 1\n")},
    {"open", shortContact("rate: 1\n"), {"--open"}},
    {"realtime", restingContact("duration_s: 0.5\nmode: realtime\nmax_missed_steps: 1000\n"), {}, false},
};

class Attacked : public ::testing::TestWithParam<std::tuple<Attack, Mode>> {};

TEST_P(Attacked, TheRunIsAsIfLeftAlone) {
  const auto& [attack, mode] = GetParam();
  if (!mode.options.empty() && attack.asks) return;  // --open is for that
  static const Alone moving(shortContact()), resting(restingContact("duration_s: 0.5\n"));
  expectUndisturbed(mode, mode.is_lockstep ? moving : resting, std::span(&attack, 1),
                    [] { return std::vector<std::size_t>{0}; });
}

INSTANTIATE_TEST_SUITE_P(By, Attacked,
                         ::testing::Combine(::testing::ValuesIn(attacks().begin(), attacks().end()),
                                            ::testing::ValuesIn(kModes)),
                         [](const auto& param) {
                           return std::string(std::get<0>(param.param).name) + "_" + std::get<1>(param.param).name;
                         });

std::optional<dds::RunKey> keyOf(const LiveRun& run) {
  const std::string text = readFile(run.folder() / "key");
  return dds::RunKey::parse(text.substr(0, text.find_last_not_of(" \n") + 1));
}

/// What comes of an attack on a run in lockstep whose key the attacker has; nothing: "".
std::string effectOf(const Attack& attack, const Alone& alone) {
  const Bench bench;
  const LiveRun run(bench, shortContact("rate: 1\n"), {"--paused"});
  Strangers members(
      run, std::span(&attack, 1), [] { return std::vector<std::size_t>{0}; }, keyOf(run));
  EXPECT_TRUE(members.areHeard());
  if (bench.baton({"sim", "resume"}).exit_code != 0) return "the run does not begin";
  const auto isPaused = [&] {
    const Finished status = bench.baton({"status", "--json"});
    return status.exit_code == 0 && nlohmann::json::parse(status.out).at("state") == "paused";
  };
  const auto isReset = [&] { return readFile(run.folder() / "plant.log").find(" reset: ") != std::string::npos; };
  const auto isOver = [&] { return std::filesystem::exists(run.folder() / "result.json"); };
  EXPECT_TRUE(eventually([&] { return isOver() || isReset() || isPaused(); }));
  members.stop();
  if (!isOver()) return isReset() ? "the run is reset" : "the run is paused";
  const nlohmann::json result = run.result();
  std::string effect;
  if (result.at("exit_code") != 0) effect += "exit code " + result.at("exit_code").dump() + "; ";
  if (result.at("chain_hash") != alone.hash) effect += "other bytes; ";
  if (!result.at("recording").at("complete")) effect += "the recording is not complete; ";
  if (result.at("recording").at("messages") < kShortSteps) effect += "most is not recorded; ";
  if (bench.baton({"bag", "verify", run.recording}).exit_code != 0) effect += "it cannot be verified; ";
  return effect;
}

class HeardAttack : public ::testing::TestWithParam<Attack> {};

/// Otherwise it would show nothing that the run is as if left alone.
TEST_P(HeardAttack, WouldNotLeaveTheRunAlone) {
  static const Alone alone(shortContact());
  const std::string effect = effectOf(GetParam(), alone);
  std::cout << GetParam().name << ": " << effect << std::endl;
  EXPECT_EQ(effect.empty(), !GetParam().bites) << effect;
}

INSTANTIATE_TEST_SUITE_P(By, HeardAttack, ::testing::ValuesIn(attacks().begin(), attacks().end()),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(Attack, AFloodOfRequestsLeavesTheRecordingComplete) {
  // With the run's key, by an operator. The recorder stands still meanwhile, as on a machine that has no time for it.
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  run.waitForStep(100);
  const std::string id = run.status.at("run");
  dds::Participant participant({.domain = bench.domain(),
                                .partition = "lab/" + id,
                                .cell = "lab",
                                .run = id,
                                .service = "operator-flood",
                                .key = keyOf(run)});
  ASSERT_TRUE(participant.hasKey());
  std::atomic<bool> is_named{false};
  const dds::Reader<msg::Event> events(participant, dds::topics::kEvent,
                                       [&](const msg::Event& event, const dds::RawSample&) {
                                         if (event.kind() == "flood") is_named = true;
                                       });
  dds::Writer<msg::SwapRequest> requests(participant, dds::topics::kSwapRequest);
  ASSERT_EQ(kill(run.pidOf("recorder"), SIGSTOP), 0);
  msg::SwapRequest request;
  request.target("pd");
  request.dry_run(true);
  EXPECT_TRUE(eventually([&] {
    for (int i = 0; i < 30; ++i) {
      request.request_id(request.request_id() + 1);
      requests.write(request);
    }
    return is_named.load();
  })) << "all of them are answered";
  ASSERT_EQ(kill(run.pidOf("recorder"), SIGCONT), 0);
  const Finished down = bench.baton({"down", "--json"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_TRUE(nlohmann::json::parse(down.out).at("recording").at("complete")) << down.out;
  EXPECT_EQ(bench.baton({"bag", "verify", run.recording}).exit_code, 0);
}

TEST(Attack, ARunBeginsAlthoughAStrangerSaysThatItIsThePlantOfAnElderRun) {
  const Bench bench;
  const Stranger elder(bench.domain(), "an-elder-run", kPlantName);  // in the same cell, and older: it is there first
  const Finished run = bench.baton({"run", bench.write("run.yaml", shortContact()), "--no-recording"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}

TEST(Attack, WhoNamesAnotherRunIsNoServiceOfThisOne) {
  // It need not claim our run to be in its partition. As the eldest plant there it would be the one that is answered.
  const Bench bench;
  Stranger elder(bench.domain(), "an-elder-run", kPlantName, "*");
  const dds::Writer<msg::PlantState> states(elder.participant(), dds::topics::kPlantState);
  const dds::Reader<msg::ServiceStatus> statuses(elder.participant(), dds::topics::kServiceStatus,
                                                 [](const msg::ServiceStatus&, const dds::RawSample&) {});
  const LiveRun run(bench, endlessContact());
  ASSERT_TRUE(eventually([&] { return states.raw().matched().size() > 3 && statuses.raw().matched().size() > 3; }));
  EXPECT_EQ(bench.baton({"controller", "stop", "pd"}).exit_code, 0);
  EXPECT_TRUE(bench.batonJson({"controller", "start", "pd", "--json"}).at("accepted"));
  EXPECT_TRUE(eventually([&] { return bench.baton({"swap", "pd", "--dry-run"}).exit_code == 0; }));
  const Finished down = bench.baton({"down", "--json"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_TRUE(nlohmann::json::parse(down.out).at("recording").at("complete")) << down.out;
}

/// Topics that are none of Baton's are recorded from anybody; what cannot be is told, and the verdict is on the run.
TEST(Attack, ATopicOfAStrangersOwnIsRemarkedAndCostsNoVerdict) {
  const Bench bench;
  const LiveRun run(bench, shortContact("rate: 1\n"), {"--paused"});
  const std::string id = run.status.at("run");
  Stranger one(bench.domain(), id, "one"), other(bench.domain(), id, "other");
  const std::vector<std::byte> payload(8, std::byte{1});
  one.sayRaw("theirs", "test::One", payload);
  other.sayRaw("theirs", "test::Other", payload);
  ASSERT_TRUE(eventually([&] { return readFile(run.folder() / "recorder.log").find("theirs") != std::string::npos; }));
  ASSERT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
  const nlohmann::json result = run.result();
  EXPECT_EQ(result.at("state"), "finished") << result;
  EXPECT_EQ(result.at("chain_hash"), Alone(shortContact()).hash);
  EXPECT_EQ(result.at("exit_code"), 0) << result;
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
  EXPECT_NE(result.at("recording").at("summary").get<std::string>().find("theirs"), std::string::npos) << result;
  const Finished verified = bench.baton({"bag", "verify", run.recording});
  EXPECT_EQ(verified.exit_code, 0) << verified.out;
  EXPECT_NE(verified.out.find("theirs"), std::string::npos) << verified.out;
}

/// DDS remembers by name whether a type has a key, for all topics of a participant.
TEST(Attack, WhoNamesATypeOfBatonForAKeyedTopicHidesNoneOfTheRun) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  Stranger stranger(bench.domain(), run.status.at("run"), "namesake");
  const std::array<std::byte, 8> payload{};
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    stranger.sayWith({.topic = "their_" + std::string(topic.name), .type = topic.type, .keyed = true}, payload);
  }
  EXPECT_TRUE(eventually([&] { return !stranger.readersOf("their_parameter_request").empty(); }));
  EXPECT_EQ(bench.baton({"param", "set", "impedance", "kp=150"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"controller", "stop", "pd"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  const std::vector<std::string> recorded = mcap::topicNames(mcap::Reader(run.recording));
  for (const char* topic : {"parameter_request", "launch_request"}) {
    EXPECT_EQ(std::ranges::count(recorded, topic), 1) << topic << " is not recorded";
  }
  EXPECT_EQ(bench.baton({"bag", "verify", run.recording}).exit_code, 0);
}

/// Answers every request of a topic at once, and falsely.
template <class Request, class Reply>
class FalseReplies {
 public:
  FalseReplies(Stranger& stranger, const dds::Topic<Request>& requests, const dds::Topic<Reply>& replies)
      : replies_(stranger.participant(), replies),
        requests_(stranger.participant(), requests, [this](const Request& request, const dds::RawSample&) {
          Reply reply;
          reply.request_id(request.request_id());
          replies_.write(reply);
          ++sent_;
        }) {}
  [[nodiscard]] int sent() const { return sent_; }

 private:
  std::atomic<int> sent_{0};
  dds::Writer<Reply> replies_;
  dds::Reader<Request> requests_;
};

TEST(Attack, TheCommandLineTakesNoAnswerFromAStranger) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  Stranger stranger(bench.domain(), run.status.at("run"), kPlantName);
  const FalseReplies sim(stranger, dds::topics::kSimRequest, dds::topics::kSimReply);
  const FalseReplies record(stranger, dds::topics::kRecordRequest, dds::topics::kRecordReply);
  const FalseReplies launch(stranger, dds::topics::kLaunchRequest, dds::topics::kLaunchReply);
  // A command's participant lives no longer than the command: now and then the stranger finds it in time.
  EXPECT_TRUE(eventually([&] {
    EXPECT_EQ(bench.baton({"sim", "pause"}).exit_code, 0);
    EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);
    return sim.sent() > 0;
  }));
  EXPECT_TRUE(eventually([&] {
    EXPECT_EQ(bench.baton({"record", "pause"}).exit_code, 0);
    EXPECT_EQ(bench.baton({"record", "resume"}).exit_code, 0);
    return record.sent() > 0;
  }));
  EXPECT_TRUE(eventually([&] {
    const Finished refused = bench.baton({"controller", "stop", "absent"});
    EXPECT_NE((refused.out + refused.err).find("no controller called absent runs"), std::string::npos) << refused.out;
    return launch.sent() > 0;
  }));
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(Attack, NoMoreThanTwentyAreToldOf) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  const std::string id = run.status.at("run");
  Stranger stranger(bench.domain(), id, "many");
  const auto told = [&] {
    const std::string log = readFile(run.folder() / "recorder.log");
    std::size_t count = 0;
    for (std::size_t at = 0; (at = log.find("control characters", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  for (int i = 0; i < 30; ++i) stranger.sayRaw("\x1b" + std::to_string(i), "test::Number", {});
  EXPECT_TRUE(eventually([&] { return told() >= kMaxStrangersTold; }));
  // They are met in this order.
  EXPECT_TRUE(eventually([&] {
    stranger.sayRaw("last", "test::Number", std::vector<std::byte>(8));
    return !stranger.readersOf("last").empty();
  }));
  EXPECT_EQ(told(), kMaxStrangersTold);
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

/// Up to three attacks a state, by all strangers together. BATON_ATTACK_MINUTES=60 repeats it with the demo for an
/// hour; BATON_ATTACK_SEED chooses the same attacks again.
TEST(AttackedAtRandom, TheRunIsAsIfLeftAlone) {
  const char* minutes = std::getenv("BATON_ATTACK_MINUTES");
  const char* seed_text = std::getenv("BATON_ATTACK_SEED");
  const auto seed = seed_text == nullptr ? std::random_device()() : static_cast<unsigned>(std::stoul(seed_text));
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(minutes == nullptr ? 0 : std::stoi(minutes));
  const std::string scenario = minutes == nullptr ? shortContact() : demoScenario();
  const Alone alone(scenario);
  std::mt19937 random(seed);
  const auto choose = [&random] {
    std::vector<std::size_t> chosen(random() % 4);
    for (std::size_t& one : chosen) one = random() % attacks().size();
    return chosen;
  };
  int runs = 0;
  do {
    expectUndisturbed({.name = "random", .scenario = scenario}, alone, attacks(), choose);
    std::cout << ++runs << " runs, seed " << seed << std::endl;
  } while (!HasFailure() && std::chrono::steady_clock::now() < end);
}

}  // namespace
}  // namespace baton::test
