// What a run leaves open to others: its files, and what its processes inherit.
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "dds/typed.hpp"
#include "runtime/cell.hpp"
#include "runtime/paths.hpp"
#include "runtime/service_options.hpp"
#include "support/live_run.hpp"
#include "support/short_contact.hpp"
#include "support/stranger.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

std::set<std::string> socketsOf(int pid) {
  std::set<std::string> sockets;
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(pid) + "/fd", gone)) {
    const std::string target = fs::read_symlink(entry.path(), gone).string();
    if (target.starts_with("socket:")) sockets.insert(target);
  }
  return sockets;
}

TEST(RunFolder, IsItsOwnersAlone) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  EXPECT_EQ(fs::status(run.folder()).permissions(), fs::perms::owner_all);
  EXPECT_EQ(fs::status(run.folder() / "key").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(RunFolder, ItsProcessesInheritNoSockets) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  std::map<std::string, std::string> owner_of;
  for (const auto& service : run.status.at("services")) {
    const std::string name = service.at("name");
    const std::set<std::string> sockets = socketsOf(service.at("pid"));
    EXPECT_FALSE(sockets.empty()) << name;
    for (const std::string& socket : sockets) {
      const auto [known, is_new] = owner_of.try_emplace(socket, name);
      EXPECT_TRUE(is_new) << name << " shares " << socket << " with " << known->second;
    }
  }
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

TEST(RunFolder, ARecordingIsNamedHoweverLongItsPathIs) {
  const Bench bench;
  const fs::path folder = bench.folder() / std::string(200, 'd') / std::string(200, 'e');
  fs::create_directories(folder);
  const std::string out = (folder / "out.mcap").string();
  const nlohmann::json result =
      bench.batonJson({"run", bench.write("run.yaml", shortContact()), "--out", out, "--json"});
  EXPECT_EQ(result.at("recording").at("path"), out) << result;
}

/// The recorder has the user's rights, so names that come over DDS must not lead it anywhere.
TEST(RunFolder, ARecordingGoesWhereTheOperatorSays) {
  const Bench bench;
  const LiveRun run(bench, endlessContact(), {"--record-later"});
  const fs::path elsewhere = bench.folder() / "elsewhere";
  fs::create_directory(elsewhere);
  for (const char* wrong : {"a.txt", "/nowhere/a.mcap", "elsewhere/.mcap"}) {
    EXPECT_EQ(bench.baton({"record", "start", "--out", (bench.folder() / wrong).string()}).exit_code, 2) << wrong;
  }
  EXPECT_EQ(bench.baton({"record", "start", "--out", bench.write("there.mcap", "")}).exit_code, 3);
  const nlohmann::json started =
      bench.batonJson({"record", "start", "--out", (elsewhere / "a.mcap").string(), "--json"});
  EXPECT_EQ(started.at("path"), (elsewhere / "a.mcap").string());
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "info", (elsewhere / "a.mcap").string()}).exit_code, 0);
}

/// Sends requests for a recording as the command line does, but with whatever is in them.
class Asker {
 public:
  Asker(const LiveRun& run, const std::optional<dds::RunKey>& key)
      : participant_({.domain = run.bench.domain(),
                      .partition = "lab/" + run.status.at("run").get<std::string>(),
                      .cell = "lab",
                      .run = run.status.at("run"),
                      .service = std::string(kOperatorPrefix) + "test",
                      .key = key}),
        reader_(participant_, dds::topics::kRecordReply,
                [this](const msg::RecordReply& reply, const dds::RawSample&) {
                  const std::lock_guard lock(mutex_);
                  replies_[reply.request_id()] = reply;
                }),
        writer_(participant_, dds::topics::kRecordRequest) {
    EXPECT_TRUE(eventually([&] { return !writer_.raw().matched().empty() && !reader_.raw().matched().empty(); }));
  }
  [[nodiscard]] msg::RecordReply ask(msg::RecordAction action, const std::string& path) {
    msg::RecordRequest request;
    request.request_id(++asked_);
    request.action(action);
    request.path(path);
    writer_.write(request);
    EXPECT_TRUE(eventually([&] {
      const std::lock_guard lock(mutex_);
      return replies_.contains(asked_);
    })) << path;
    const std::lock_guard lock(mutex_);
    return replies_[asked_];
  }

 private:
  dds::Participant participant_;
  std::mutex mutex_;
  std::map<std::uint64_t, msg::RecordReply> replies_;
  dds::Reader<msg::RecordReply> reader_;
  dds::Writer<msg::RecordRequest> writer_;
  std::uint64_t asked_ = 0;
};

void expectPathsAreRefused(const Bench& bench, Asker& asker, msg::RecordAction action) {
  for (const char* name : {"/tmp/authorized_keys", "/tmp/a.mcap", "../a.mcap", "a\n.mcap", ".mcap", "a.txt"}) {
    const msg::RecordReply reply = asker.ask(action, name);
    EXPECT_FALSE(reply.accepted()) << name;
    EXPECT_NE(std::string(reply.text().c_str()).find("expected the name of a file"), std::string::npos)
        << name << ": " << reply.text().c_str();
  }
  for (const auto& entry : fs::recursive_directory_iterator(bench.folder())) {
    EXPECT_NE(entry.path().filename(), "a.mcap");
    EXPECT_NE(entry.path().extension(), ".txt") << entry.path();
  }
}

/// The command line sends names that are in order. The recorder does not rely on that.
TEST(RunFolder, TheRecorderTakesNamesOnlyAlsoFromWhoHasTheKey) {
  const Bench bench;
  {
    const LiveRun run(bench, endlessContact(), {"--record-later"});
    Asker asker(run, readKey((run.folder() / "key").string()));
    expectPathsAreRefused(bench, asker, msg::RECORD_START);
    EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  }
  const LiveRun run(bench, endlessContact("recording: {ring_s: 0.1}\n"), {"--overwrite"});
  Asker asker(run, readKey((run.folder() / "key").string()));
  expectPathsAreRefused(bench, asker, msg::RECORD_SNAPSHOT);
  EXPECT_TRUE(asker.ask(msg::RECORD_SNAPSHOT, "snapshot.mcap").accepted());
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(bench.folder() / "snapshot.mcap"));
}

TEST(RunFolder, AnOpenRunTakesRequestsFromAnybodyAndNothingElse) {
  const Bench bench;
  const LiveRun run(bench, endlessContact(), {"--open", "--record-later"});
  Asker anybody(run, std::nullopt);
  expectPathsAreRefused(bench, anybody, msg::RECORD_START);
  EXPECT_TRUE(anybody.ask(msg::RECORD_START, "anybodys.mcap").accepted());
  Stranger stranger(bench.domain(), run.status.at("run"), kEnvironmentName);
  ASSERT_TRUE(eventually([&] {
    stranger.say(dds::topics::kContact, msg::Contact{});
    return stranger.readersOf("contact").contains(kPlantName);
  }));
  ASSERT_TRUE(stranger.hasArrived("contact"));
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  const std::string log = readFile(run.folder() / "plant.log");
  EXPECT_NE(log.find("contact: "), std::string::npos) << log;
  EXPECT_NE(log.find(" of strangers, not heard"), std::string::npos) << log;
}

}  // namespace
}  // namespace baton::test
