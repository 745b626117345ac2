// Whoever comes under the GUID prefix of a process of the run inherits nothing from it.
#include <gtest/gtest.h>
#include <signal.h>

#include <optional>
#include <string>

#include "runtime/paths.hpp"
#include "runtime/service_options.hpp"
#include "support/impostor.hpp"
#include "support/live_run.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

/// By what the DDS product lets anybody set: whoever comes under the GUID prefix of a process of the run, with its
/// words.
class Heir {
 public:
  Heir(const LiveRun& run, const Words& words)
      : run_(run), id_(dds::toString(words.prefix)), impostor_(run.bench.domain(), words, partitionOf(run)) {}
  [[nodiscard]] static std::string partitionOf(const LiveRun& run) {
    return "lab/" + run.status.at("run").get<std::string>();
  }
  /// Says it until the plant has it, and refuses it by name.
  template <class T>
  [[nodiscard]] bool isRefused(const dds::Topic<T>& topic, const T& message) {
    return eventually([&] {
      if (impostor_.say(topic, message) == 0) return false;
      const std::string log = readFile(run_.folder() / "plant.log");
      const std::size_t told = log.find("a stranger writes on " + std::string(topic.name) + " under the GUID of");
      return told != std::string::npos && log.find(id_, told) != std::string::npos;
    });
  }

 private:
  const LiveRun& run_;
  std::string id_;
  Impostor impostor_;
};

/// The words of a service of the run, or of a command.
Words wordsOf(const Impostor& spy, const std::string& name) {
  std::optional<Words> words;
  EXPECT_TRUE(eventually([&] {
    words = spy.wordsOf([&](const Words& one) { return one.user_data.find("\n" + name) != std::string::npos; });
    return words.has_value();
  })) << name;
  return words.value_or(Words{});
}

TEST(Heirs, WhoCopiesACommandThatHasLeftIsNobody) {
  const Bench bench;
  const Impostor spy(bench.domain(), {});
  const LiveRun run(bench, endlessContact());
  ASSERT_EQ(bench.baton({"status"}).exit_code, 0);
  Heir heir(run, wordsOf(spy, kOperatorPrefix));
  msg::SimRequest stop;
  stop.request_id(1);
  stop.action(msg::SIM_STOP);
  EXPECT_TRUE(heir.isRefused(dds::topics::kSimRequest, stop));
  const Finished down = bench.baton({"down", "--json"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_TRUE(nlohmann::json::parse(down.out).at("recording").at("complete")) << down.out;
  EXPECT_EQ(bench.baton({"bag", "verify", run.recording}).exit_code, 0);
}

TEST(Heirs, WhoCopiesAControllerThatWasStoppedIsNobody) {
  const Bench bench;
  const Impostor spy(bench.domain(), {});
  const LiveRun run(bench, endlessContact());
  const Words words = wordsOf(spy, "pd\n");
  ASSERT_EQ(bench.baton({"controller", "stop", "pd"}).exit_code, 0);
  ASSERT_TRUE(eventually([&] { return processesWith("--name pd").empty(); }));
  Heir heir(run, words);
  msg::ServiceStatus ready;
  ready.name("pd");
  ready.role("controller");
  ready.state(msg::SERVICE_READY);
  ready.pid(run.pidOf("pd"));
  EXPECT_TRUE(heir.isRefused(dds::topics::kServiceStatus, ready));
  const Finished down = bench.baton({"down", "--json"});
  EXPECT_EQ(down.exit_code, 0) << down.out << down.err;
  EXPECT_TRUE(nlohmann::json::parse(down.out).at("recording").at("complete")) << down.out;
  EXPECT_EQ(bench.baton({"bag", "verify", run.recording}).exit_code, 0);
}

/// It says no farewell: for DDS it is alive, and its prefix could be had.
TEST(Heirs, NobodyInheritsFromAControllerThatWasKilled) {
  const Bench bench;
  const LiveRun run(bench, endlessContact());
  const int pid = run.pidOf("pd");
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  for (const char* service : {kPlantName, kEnvironmentName, kTrajectoryName, kRecorderName, "tracking"}) {
    EXPECT_TRUE(eventually([&] {
      const std::string log = readFile(run.folder() / (std::string(service) + ".log"));
      return log.find("pd has ended (process " + std::to_string(pid) + ")") != std::string::npos;
    })) << service;
  }
  EXPECT_EQ(bench.baton({"down"}).exit_code, 1) << "a controller has failed";
}

}  // namespace
}  // namespace baton::test
