// The daily commands on a live run, and what they say to wrong input.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "runtime/paths.hpp"
#include "support/live_run.hpp"
#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

TEST(CommandLine, OperatesALiveRun) {
  const Bench bench;
  const Finished up = bench.baton({"up", "lab"});
  ASSERT_EQ(up.exit_code, 0) << up.out << up.err;

  nlohmann::json status;
  EXPECT_TRUE(eventually([&] {
    status = bench.batonJson({"status", "--json"});
    return std::ranges::all_of(status.at("services"), [](const auto& one) { return one.at("state") == "ready"; });
  })) << status;
  EXPECT_EQ(status.at("state"), "running");
  EXPECT_EQ(status.at("holder"), "impedance");
  std::set<std::string> services;
  for (const auto& service : status.at("services")) services.insert(service.at("name"));
  services.erase("supervisor");  // speaks like a service, but computes no step
  EXPECT_EQ(services, (std::set<std::string>{"plant", "environment", "trajectory", "recorder", "tracking", "joint",
                                             "impedance", "force"}));

  const nlohmann::json paused = bench.batonJson({"sim", "pause", "--json"});
  EXPECT_TRUE(paused.at("accepted"));
  const std::uint64_t held = paused.at("step");
  EXPECT_EQ(bench.batonJson({"status", "--json"}).at("state"), "paused");
  EXPECT_EQ(bench.baton({"sim", "step", "25"}).exit_code, 0);
  EXPECT_TRUE(eventually([&] {
    const nlohmann::json now = bench.batonJson({"status", "--json"});
    return now.at("state") == "paused" && now.at("step") == held + 25;
  }));
  EXPECT_EQ(bench.baton({"sim", "rate", "max"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"sim", "resume"}).exit_code, 0);

  const nlohmann::json swap = bench.batonJson({"swap", "tracking", "--json"});
  EXPECT_TRUE(swap.at("done")) << swap;
  EXPECT_EQ(swap.at("at_step").get<std::uint64_t>() - swap.at("decided_at_step").get<std::uint64_t>(), 6U);
  const nlohmann::json again = bench.batonJson({"swap", "tracking", "--json"});
  EXPECT_FALSE(again.at("done"));
  EXPECT_NE(again.at("reason").get<std::string>().find("already"), std::string::npos);
  const nlohmann::json nobody = bench.batonJson({"swap", "nobody", "--json"});
  EXPECT_FALSE(nobody.at("done"));
  EXPECT_EQ(bench.baton({"swap", "nobody"}).exit_code, 1);

  const nlohmann::json controllers = bench.batonJson({"controllers", "--json"});
  ASSERT_EQ(controllers.size(), 4U);
  for (const auto& one : controllers) {
    EXPECT_EQ(one.at("state"), one.at("name") == "tracking" ? "active" : "standby") << one;
    EXPECT_EQ(one.at("effort").size(), 3U) << one;
  }
  const nlohmann::json parameters = bench.batonJson({"param", "list", "--json"});
  ASSERT_EQ(parameters.size(), 4U);
  const nlohmann::json one = bench.batonJson({"param", "list", "impedance", "--json"}).at(0);
  EXPECT_EQ(one.at("law"), "impedance");
  const auto kp = std::find_if(one.at("parameters").begin(), one.at("parameters").end(),
                               [](const nlohmann::json& parameter) { return parameter.at("name") == "kp"; });
  ASSERT_NE(kp, one.at("parameters").end());
  EXPECT_EQ(kp->at("value"), (std::vector<double>(6, 200.0))) << *kp;
  EXPECT_EQ(kp->at("unit"), "N/m; N m/rad");
  EXPECT_EQ(bench.baton({"param", "list", "nobody"}).exit_code, 2);
  const nlohmann::json record = bench.batonJson({"record", "status", "--json"});
  EXPECT_EQ(record.at("state"), "recording");
  EXPECT_EQ(record.at("lost"), 0);
  EXPECT_EQ(bench.baton({"logs", "plant"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"logs", "nobody"}).exit_code, 2);

  // The cell is taken.
  const Finished second = bench.baton({"up", "lab"});
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_NE(second.err.find("is in use"), std::string::npos) << second.err;

  const nlohmann::json result = bench.batonJson({"down", "--json"});
  EXPECT_EQ(result.at("state"), "stopped");
  EXPECT_TRUE(result.at("recording").at("complete")) << result;
  EXPECT_EQ(bench.baton({"status"}).exit_code, 3);
  EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
}

TEST(CommandLine, EveryCommandHasHelp) {
  const Bench bench;
  for (const std::vector<std::string>& command : {std::vector<std::string>{"demo"},
                                                  {"up"},
                                                  {"run"},
                                                  {"down"},
                                                  {"status"},
                                                  {"controllers"},
                                                  {"swap"},
                                                  {"sim"},
                                                  {"sim", "pause"},
                                                  {"sim", "resume"},
                                                  {"sim", "step"},
                                                  {"sim", "rate"},
                                                  {"sim", "stop"},
                                                  {"sim", "reset"},
                                                  {"branch"},
                                                  {"bag", "hash"},
                                                  {"record", "status"},
                                                  {"param"},
                                                  {"param", "list"},
                                                  {"logs"},
                                                  {"replay"},
                                                  {"bag"},
                                                  {"bag", "info"},
                                                  {"bag", "verify"},
                                                  {"bag", "recover"},
                                                  {"bag", "merge"},
                                                  {"bag", "cut"},
                                                  {"model"}}) {
    std::vector<std::string> arguments = command;
    arguments.emplace_back("--help");
    const Finished help = runProgram(programFolder() / "baton", arguments, bench.folder());
    EXPECT_EQ(help.exit_code, 0) << command.front() << help.err;
    EXPECT_GT(help.out.size(), 50U) << command.front();
  }
}

TEST(CommandLine, RefusesNumbersThatAreNone) {
  const Bench bench;
  for (const std::vector<std::string>& command : {std::vector<std::string>{"sim", "step", "-1"},
                                                  {"sim", "pause", "--at", "-1"},
                                                  {"sim", "pause", "--at-time", "nan"},
                                                  {"sim", "rate", "1e-300"},
                                                  {"swap", "pd", "--at", "-5"},
                                                  {"swap", "pd", "--blend", "nan"},
                                                  {"branch", "x.mcap", "--at-time", "nan"},
                                                  {"branch", "x.mcap", "--at-time", "-1"},
                                                  {"branch", "x.mcap", "--at-time", "1e300"}}) {
    const Finished refused = bench.baton(command);
    EXPECT_EQ(refused.exit_code, 2) << refused.out << refused.err;
    EXPECT_NE(refused.err.find(command.back()), std::string::npos) << refused.err;
  }
}

TEST(CommandLine, AFolderThatCannotBeMadeIsSaid) {
  const Bench bench;
  const std::string in_the_way = bench.write("cells", "a file where a folder should be");
  const Finished refused = bench.baton({"status"});
  EXPECT_EQ(refused.exit_code, 3) << refused.err;
  EXPECT_NE(refused.err.find("cannot make the folder " + in_the_way), std::string::npos) << refused.err;
  const Finished too_long = bench.baton({"run", std::string(5000, 'a')});
  EXPECT_EQ(too_long.exit_code, 2) << too_long.err;
  EXPECT_EQ(too_long.err.find("unexpected"), std::string::npos) << too_long.err;
}

TEST(CommandLine, RefusesWrongInputWithWhereAndWhy) {
  const Bench bench;
  const auto expectRefusal = [&](const std::string& text, const std::vector<std::string>& words) {
    const Finished finished = bench.baton({"run", bench.write("bad.yaml", text)});
    EXPECT_EQ(finished.exit_code, 2) << finished.out << finished.err;
    for (const std::string& word : words)
      EXPECT_NE(finished.err.find(word), std::string::npos) << word << "\n" << finished.err;
  };
  expectRefusal(shortContact("stiffnes: 3\n"), {"bad.yaml:23:", "unknown key 'stiffnes'", "known:"});
  expectRefusal("name: x\nrobot: nowhere.yaml\n", {"bad.yaml:", "nowhere.yaml"});
  expectRefusal("name: [", {"bad.yaml:"});
  const Finished missing = bench.baton({"run", "no_such_scenario"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("demo"), std::string::npos) << missing.err;
  EXPECT_EQ(bench.baton({"run", "demo", "--transport", "smoke"}).exit_code, 2);
  EXPECT_EQ(bench.baton({"swap"}).exit_code, 2) << "a name is required";
  EXPECT_EQ(bench.baton({"sim"}).exit_code, 2) << "a subcommand is required";
  const Finished unknown = bench.baton({"statuss"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("did you mean 'status'"), std::string::npos) << unknown.err;
  EXPECT_EQ(runProgram(programFolder() / "baton", {"status", "--domain", "999"}, bench.folder()).exit_code, 2);
  EXPECT_EQ(bench.baton({"down"}).exit_code, 3);
  EXPECT_EQ(bench.baton({"logs"}).exit_code, 3);
  EXPECT_EQ(bench.baton({"up", "demo", "--cell", "a/b"}).exit_code, 2);
  EXPECT_TRUE(processesWith(bench.folder().string()).empty());
}

TEST(CommandLine, ModelPrintsTheReportsDigits) {
  const Bench bench;
  const nlohmann::json model = bench.batonJson({"model", "--robot", "rpp", "--q", "pi/3", "0.1", "0.1", "--json"});
  const std::string text = model.dump();
  // Printed in the report: p = (0.3250, -0.5600, 0.9629), g = (2.3767, 0, 0.3439).
  EXPECT_NE(text.find("2.3767"), std::string::npos) << text;
  EXPECT_NE(text.find("0.3439"), std::string::npos) << text;
  EXPECT_NE(text.find("0.9629"), std::string::npos) << text;
}

TEST(CommandLine, ModelTakesNumbersWithOneKindOfSeparator) {
  const Bench bench;
  EXPECT_EQ(bench.baton({"model", "--robot", "rpp", "--q=-pi/6,+0.2,0.1"}).exit_code, 0);
  EXPECT_EQ(bench.baton({"model", "--robot", "rpp", "--q", "pi/6", "+0.2", "0.1"}).exit_code, 0);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"0,5"}, {"0", "0,5", "1"}, {"0,5", "1"}}) {
    std::vector<std::string> arguments{"model", "--robot", "rpp", "--q"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Finished refused = bench.baton(arguments);
    EXPECT_EQ(refused.exit_code, 2) << refused.out;
    EXPECT_NE(refused.err.find("--q: expected 3 numbers, one per joint"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("; the decimal sign is a point"), std::string::npos) << refused.err;
  }
}

TEST(CommandLine, AsManyStepsAsCanBeAskedForAreWaitedFor) {
  Bench bench;
  const LiveRun run(bench, endlessContact(), {"--paused"});
  ASSERT_EQ(bench.baton({"sim", "step", "5"}).exit_code, 0);
  const int stepping = bench.start(
      "baton", {"sim", "step", "18446744073709551615", "--domain", std::to_string(bench.domain())}, "step.log");
  run.waitForStep(100);
  const std::uint64_t at = bench.batonJson({"sim", "pause", "--json"}).at("step");
  EXPECT_EQ(bench.wait(stepping), 0);
  EXPECT_EQ(readFile(bench.folder() / "step.log"), "done at step " + std::to_string(at) + "\n");
  EXPECT_EQ(bench.baton({"down"}).exit_code, 0);
}

}  // namespace
}  // namespace baton::test
