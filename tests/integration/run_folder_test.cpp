// What a run leaves open to others: its files, and what its processes inherit.
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <set>

#include "dds/typed.hpp"
#include "runtime/cell.hpp"
#include "runtime/service_options.hpp"
#include "support/live_run.hpp"
#include "support/short_contact.hpp"

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

/// The command line sends names that are in order. The recorder does not rely on that.
TEST(RunFolder, TheRecorderTakesNamesOnlyAlsoFromWhoHasTheKey) {
  const Bench bench;
  const LiveRun run(bench, endlessContact(), {"--record-later"});
  const std::string id = run.status.at("run");
  dds::Participant participant({.domain = bench.domain(),
                                .partition = "lab/" + id,
                                .cell = "lab",
                                .run = id,
                                .service = std::string(kOperatorPrefix) + "test",
                                .key = readKey((run.folder() / "key").string())});
  std::mutex mutex;
  std::map<std::uint64_t, msg::RecordReply> replies;
  const dds::Reader<msg::RecordReply> reader(participant, dds::topics::kRecordReply,
                                             [&](const msg::RecordReply& reply, const dds::RawSample&) {
                                               const std::lock_guard lock(mutex);
                                               replies[reply.request_id()] = reply;
                                             });
  dds::Writer<msg::RecordRequest> writer(participant, dds::topics::kRecordRequest);
  ASSERT_TRUE(eventually([&] { return !writer.raw().matched().empty() && !reader.raw().matched().empty(); }));
  std::uint64_t asked = 0;
  for (const auto action : {msg::RECORD_START, msg::RECORD_SNAPSHOT}) {
    for (const char* name : {"/tmp/authorized_keys", "/tmp/a.mcap", "../a.mcap", "a\n.mcap", ".mcap", "a.txt"}) {
      msg::RecordRequest request;
      request.request_id(++asked);
      request.action(action);
      request.path(name);
      writer.write(request);
      ASSERT_TRUE(eventually([&] {
        const std::lock_guard lock(mutex);
        return replies.contains(asked);
      })) << name;
      EXPECT_FALSE(replies.at(asked).accepted()) << name;
    }
  }
  EXPECT_NE(std::string(replies.at(1).text().c_str()).find("expected the name of a file"), std::string::npos)
      << replies.at(1).text().c_str();
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  for (const auto& entry : fs::recursive_directory_iterator(bench.folder()))
    EXPECT_NE(entry.path().extension(), ".mcap") << entry.path();
}

}  // namespace
}  // namespace baton::test
