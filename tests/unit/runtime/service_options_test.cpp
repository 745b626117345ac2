// What the supervisor tells a service is what the service understands.
#include "runtime/service_options.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

ServiceOptions understood(const ServiceOptions& told) {
  std::vector<std::string> arguments = toArguments(told);
  arguments.insert(arguments.begin(), "baton-" + told.role);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  ServiceOptions options;
  EXPECT_TRUE(parseServiceOptions(static_cast<int>(argv.size()), argv.data(), told.role, options)) << told.role;
  return options;
}

TEST(ServiceOptions, ArriveAsTheyWereGiven) {
  for (const std::string role : {"plant", "environment", "trajectory", "recorder", "controller"}) {
    ServiceOptions told;
    told.role = told.name = role;
    told.scenario_file = "a file.yaml";
    told.robot_file = "robot.yaml";
    told.cell = "two";
    told.run = "20000101-000000-0000";
    told.domain = 7;
    told.transport = dds::Transport::kSharedMemory;
    told.recording = false;
    told.checkpoint = "at-800.json";
    told.scheduling.fifo_priority = 50;
    told.clock = dds::WallClock(-5'000'000'000);
    told.starts_paused = role == "plant";
    told.supervised = role == "plant" || role == "recorder";
    if (role == "controller") {
      told.name = "pd";
      told.law = "joint_pd";
    }
    if (role == "recorder") {
      told.out = "out.mcap";
      told.record_later = true;
    }
    const ServiceOptions got = understood(told);
    EXPECT_EQ(toArguments(got), toArguments(told)) << role;
    EXPECT_EQ(got.name, told.name);
    EXPECT_EQ(got.scenario_file, told.scenario_file);
    EXPECT_EQ(got.robot_file, told.robot_file);
    EXPECT_EQ(got.cell, told.cell);
    EXPECT_EQ(got.run, told.run);
    EXPECT_EQ(got.domain, told.domain);
    EXPECT_EQ(got.transport, told.transport);
    EXPECT_EQ(got.recording, told.recording);
    EXPECT_EQ(got.checkpoint, told.checkpoint);
    EXPECT_EQ(got.scheduling.fifo_priority, told.scheduling.fifo_priority);
    EXPECT_EQ(got.starts_paused, told.starts_paused);
    EXPECT_EQ(got.supervised, told.supervised);
    EXPECT_EQ(got.law, told.law);
    EXPECT_EQ(got.out, told.out);
    EXPECT_EQ(got.record_later, told.record_later);
    EXPECT_EQ(got.clock, told.clock) << "one that is started later counts the run's time";
  }
}

TEST(ServiceOptions, OnlyARunThatIsSupervisedWaitsForTheSupervisor) {
  ServiceOptions options;
  EXPECT_EQ(withSupervisor({"recorder"}, options), std::vector<std::string>{"recorder"});
  options.supervised = true;
  EXPECT_EQ(withSupervisor({"recorder"}, options), (std::vector<std::string>{"recorder", "supervisor"}));
}

}  // namespace
}  // namespace baton
