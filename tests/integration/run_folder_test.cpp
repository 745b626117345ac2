// What a run leaves open to others: its files, and what its processes inherit.
#include <gtest/gtest.h>

#include <set>

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
  const nlohmann::json started =
      bench.batonJson({"record", "start", "--out", (elsewhere / "a.mcap").string(), "--json"});
  EXPECT_EQ(started.at("path"), (elsewhere / "a.mcap").string());
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"bag", "info", (elsewhere / "a.mcap").string()}).exit_code, 0);
}

}  // namespace
}  // namespace baton::test
