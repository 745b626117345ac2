// Realtime runs: the plant waits for nobody. How late others are is the machine's business; what must hold whatever it
// does is tested here.
#include <gtest/gtest.h>

#include <signal.h>

#include <cmath>

#include "msg/loop.h"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

TEST(RealtimeRun, PublishesEveryStepOnceAndEndsOnTime) {
  const Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  std::string text = shortContact("mode: realtime\nrate: 1\n");
  text.replace(text.find("step_s: 0.0005"), 14, "step_s: 0.0010");
  const nlohmann::json result = bench.batonJson({"run", bench.write("realtime.yaml", text), "--out", file, "--json"});
  ASSERT_EQ(result.at("state"), "finished") << result;
  EXPECT_GE(result.at("elapsed_s").get<double>(), 0.5 - 1e-3);  // it may be late, never early
  const nlohmann::json& timing = result.at("timing");
  for (const char* quantity : {"period_us", "jitter_us", "command_age_steps"}) {
    EXPECT_EQ(timing.at(quantity).at("count"), 500) << quantity;
  }
  // A torque is as old as commands were missed in a row, of which there are no more than were missed.
  EXPECT_EQ(timing.at("missed"), result.at("missed_steps"));
  EXPECT_LE(timing.at("command_age_steps").at("max"), result.at("missed_steps"));

  Streams streams = loopStreams(file);
  const auto states = decodeStream<msg::PlantState>(streams[{"plant_state", "plant"}]);
  ASSERT_EQ(states.size(), 501U);
  for (std::size_t k = 0; k < states.size(); ++k) {
    ASSERT_EQ(states[k].step(), k);
    for (const double position : states[k].position()) ASSERT_TRUE(std::isfinite(position)) << k;
  }
}

TEST(RealtimeRun, BrakesWhenItsControllerIsSilent) {
  const Bench bench;
  std::string text =
      shortContact("mode: realtime\nrate: 1\nmax_missed_steps: 5\nlate: {policy: fallback, after_s: 10}\n");
  text.replace(text.find("duration_s: 0.5"), 15, "duration_s: 0  ");
  text.erase(text.find("swaps:"), text.find("mode:") - text.find("swaps:"));
  ASSERT_EQ(bench.baton({"up", bench.write("realtime.yaml", text)}).exit_code, 0);
  EXPECT_TRUE(eventually([&] {
    return !bench.batonJson({"status", "--json"}).at("timing").at("jitter_us").is_null();
  }));
  int holder = 0;
  const nlohmann::json status = bench.batonJson({"status", "--json"});
  for (const auto& service : status.at("services")) {
    if (service.at("name") == "tracking") holder = service.at("pid");
  }
  ASSERT_GT(holder, 0) << status;
  kill(holder, SIGSTOP);
  EXPECT_TRUE(eventually([&] { return bench.batonJson({"status", "--json"}).at("holder") == ""; }));
  kill(holder, SIGCONT);
  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_GE(result.at("missed_steps"), 5) << result;
  // No torque is kept for longer, then the brake has its own. A step whose contact is late makes the command no older.
  EXPECT_GE(result.at("timing").at("command_age_steps").at("max"), 1) << result;
  EXPECT_LE(result.at("timing").at("command_age_steps").at("max"), 5) << result;
}

}  // namespace
}  // namespace baton::test
