/// The files under deploy/ are what people try first and copy: all of them load, and say what is so.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "bad_input.hpp"
#include "control/law.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

using test::deployFolder;
using test::refusal;
using test::replaced;

TEST(DeployedScenarios, AllLoadAndAreNamedAfterTheirFiles) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator((deployFolder() / "scenarios").string())) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    Scenario s;
    ASSERT_NO_THROW(s = loadScenario(entry.path().string()));
    EXPECT_EQ(s.name, entry.path().stem().string());
    EXPECT_FALSE(s.description.empty());
    ++count;
  }
  EXPECT_GE(count, 40u);  // it did go into report/
}

/// The scenarios' names in a folder below deploy/scenarios.
std::set<std::string> scenariosIn(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator((deployFolder() / ("scenarios/" + folder)).string())) {
    names.insert(entry.path().stem().string());
  }
  return names;
}

TEST(DeployedReport, RunsToAnEndAndIsRecorded) {
  for (const std::string folder : {"report", "cosim", "handover"}) {
    for (const std::string& name : scenariosIn(folder)) {
      SCOPED_TRACE(name);
      const Scenario s = loadScenario((deployFolder() / ("scenarios/" + folder + "/" + name + ".yaml")).string());
      EXPECT_GT(s.end_step, 0u);
      EXPECT_TRUE(s.recording.enabled);
      EXPECT_EQ(s.mode, SimMode::kLockstep);
      EXPECT_EQ(s.rate, 0.0);  // as fast as possible
    }
  }
}

TEST(DeployedReport, StartsEachScenarioByNamingItsFigure) {
  for (const std::string& name : scenariosIn("report")) {
    SCOPED_TRACE(name);
    std::istringstream lines(readYamlFile((deployFolder() / ("scenarios/report/" + name + ".yaml")).string()));
    std::string head;
    for (std::string line; std::getline(lines, line) && line.starts_with("# ");) head += line;
    const std::size_t number = std::stoul(name.substr(3));
    EXPECT_NE(head.find("Figure"), std::string::npos);
    EXPECT_NE(head.find(std::to_string(number)), std::string::npos);
  }
}

TEST(DeployedReport, ShowsEveryScenarioInAFigureAndHasAllThatItShows) {
  const std::string file = (deployFolder() / "figures/report.yaml").string();
  const YamlMap list = YamlNode::parse(file, readYamlFile(file)).map({"figures", "studies", "errata"});
  std::set<std::string> shown;
  for (const YamlNode& node : list["figures"].list(1, 100)) {
    const YamlMap figure = node.map(
        {"figure", "title", "claim", "theory", "finding", "claim_holds", "runs", "plots", "until_s", "checks"});
    for (const char* text : {"figure", "title", "claim", "theory", "finding"}) {
      EXPECT_FALSE(figure[text].text().empty());
    }
    EXPECT_FALSE(figure["plots"].list(1, 7).empty());
    EXPECT_FALSE(figure["checks"].list(1, 20).empty());
    for (const YamlNode& run : figure["runs"].list(1, 10)) {
      shown.insert(run.map({"scenario", "label"})["scenario"].text());
    }
  }
  EXPECT_EQ(shown, scenariosIn("report"));
  std::map<std::string, std::set<std::string>> studied;  // by folder
  for (const YamlNode& node : list["studies"].list(1, 100)) {
    const YamlMap study =
        node.map({"study", "title", "question", "theory", "finding", "folder", "runs", "charts", "checks", "table"});
    for (const char* text : {"study", "title", "question", "theory", "finding"}) {
      EXPECT_FALSE(study[text].text().empty());
    }
    for (const YamlNode& run : study["runs"].list(1, 10)) {
      studied[study["folder"].text()].insert(run.map({"scenario", "label"})["scenario"].text());
    }
  }
  EXPECT_EQ(studied.size(), 2U);
  for (const auto& [folder, scenarios] : studied) EXPECT_EQ(scenarios, scenariosIn(folder)) << folder;
  for (const YamlNode& node : list["errata"].list(1, 100)) {
    const YamlMap erratum = node.map({"where", "printed", "right", "evidence", "printed_cannot_run", "figures"});
    for (const char* text : {"where", "printed", "right", "evidence"}) EXPECT_FALSE(erratum[text].text().empty());
    if (const auto figures = erratum.find("figures")) {
      EXPECT_FALSE(figures->list(1, 8).empty());
    }
  }
}

TEST(DeployedRobots, AllLoadAndAreNamedAfterTheirFiles) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator((deployFolder() / "robots").string())) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    EXPECT_EQ(loadRobot(entry.path().string()).name, entry.path().stem().string());
  }
}

TEST(DeployedDemo, TellsTheStoryItsCommentsTell) {
  const Scenario s = loadScenario((deployFolder() / "scenarios/demo.yaml").string());
  const Trajectory trajectory(s.robot, s.trajectory);
  const double wall = s.walls.at(0).point_m.z();
  const auto height = [&](std::uint64_t step) {
    Reference reference;
    trajectory.evaluate(static_cast<double>(step) * s.stepSeconds(), reference);
    return reference.X_WE.p.z();
  };
  ASSERT_EQ(s.swaps.size(), 3u);
  EXPECT_EQ(s.active, "tracking");
  // One that is refused, before the wall; a handover in free motion, and one with the path inside the wall.
  EXPECT_EQ(s.swaps[0].to, "force");
  EXPECT_EQ(s.swaps[0].expect, SwapExpectation::kRefused);
  EXPECT_LT(height(s.swaps[0].at_step), wall);
  EXPECT_EQ(s.swaps[1].to, "impedance");
  EXPECT_NEAR(height(s.swaps[1].at_step), 0.555, 0.5e-3);
  EXPECT_LT(height(s.swaps[1].at_step), wall);
  EXPECT_EQ(s.swaps[2].to, "force");
  EXPECT_NEAR(height(s.swaps[2].at_step), wall + 0.025, 1e-12);
  // Who fails is the holder, when it has come to rest, and the first fallback is impedance.
  ASSERT_EQ(s.faults.size(), 1u);
  EXPECT_EQ(s.faults[0].service, "force");
  EXPECT_EQ(s.faults[0].from_step, 16000u);
  EXPECT_EQ(s.baton.fallback.at(0), "impedance");
  EXPECT_TRUE(findLaw(s.controller("force").law).requires_contact);
  // The path meets the wall at 1.56 s.
  EXPECT_LT(height(3120), wall);
  EXPECT_GT(height(3140), wall);
  // Two springs in balance: Kp (z_d - z) = Ke (z - z_r) leaves 12.5 mm and 2.5 N.
  const double kp = numbers(s.controller("impedance").parameters, "kp")[2], ke = s.walls[0].stiffness_N_per_m;
  const double z = (kp * height(s.end_step) + ke * wall) / (kp + ke);
  EXPECT_NEAR(height(s.end_step) - z, 0.0125, 1e-12);
  EXPECT_NEAR(ke * (z - wall), 2.5, 1e-9);
  EXPECT_EQ(s.trajectory.h_d.z(), 3.0);
}

/// The keys that a reader knows, from what it says about one that it does not.
std::vector<std::string> knownKeys(const std::string& message) {
  const std::size_t at = message.find("nown: ");
  EXPECT_NE(at, std::string::npos) << message;
  std::istringstream list(message.substr(at + 6));
  std::vector<std::string> keys;
  for (std::string key; std::getline(list >> std::ws, key, ',');) keys.push_back(key);
  return keys;
}

TEST(DeployedDemo, ExplainsEveryKey) {
  const std::string text = readYamlFile((deployFolder() / "scenarios/demo.yaml").string());
  const std::string robot = readYamlFile((deployFolder() / "robots/rpp.yaml").string());
  // Places of the file where an unknown key can be put, in blocks and in flows; a sine and noise are only in comments.
  const std::string waypoints =
      text.substr(text.find("  waypoints:"), text.find("  force_N:") - text.find("  waypoints:"));
  const std::vector<std::pair<std::string, std::string>> places{
      {"name: demo", "zzz: 1\nname: demo"},
      {"late: {", "late: {zzz: 1, "},
      {"start: {", "start: {zzz: 1, "},
      {"  walls:", "  zzz: 1\n  walls:"},
      {"- point_m:", "- zzz: 1\n      point_m:"},
      {"  force_N:", "  zzz: 1\n  force_N:"},
      {"- {time_s: 0, position: [0, 0, 0]} ", "- {zzz: 1, time_s: 0, position: [0, 0, 0]} "},
      {waypoints, "  sine: {zzz: 1}\n"},
      {"  force_N:", "  noise: {zzz: 1}\n  force_N:"},
      {"- name: tracking", "- zzz: 1\n    name: tracking"},
      {"- {at_s: 1.0", "- {zzz: 1, at_s: 1.0"},
      {"- {do: nan", "- {zzz: 1, do: nan"},
      {"  margin_steps:", "  zzz: 1\n  margin_steps:"},
      {"  compression:", "  zzz: 1\n  compression:"}};
  std::size_t count = 0;
  for (const auto& [from, to] : places) {
    std::string changed = replaced(text, from, to);
    if (from == waypoints) changed = replaced(changed, "  interpolation: quintic ", "  # ");
    for (const std::string& key :
         knownKeys(refusal([&] { return parseScenario("d.yaml", changed, "r.yaml", robot); }))) {
      EXPECT_NE(text.find(key + ":"), std::string::npos) << key;
      ++count;
    }
  }
  EXPECT_GE(count, 50u);  // it did read lists of keys
}

TEST(DeployedDemo, HasExamplesInItsCommentsThatWork) {
  const std::string text = readYamlFile((deployFolder() / "scenarios/demo.yaml").string());
  const std::string robot = readYamlFile((deployFolder() / "robots/rpp.yaml").string());
  // The commented lines from the one that has this key on, without their '# '.
  const auto example = [&](const std::string& key) {
    std::istringstream lines(text.substr(text.find("\n#   " + key + ":") + 1));
    std::string block;
    for (std::string line; std::getline(lines, line) && line.starts_with("#   ");) block += line.substr(2) + "\n";
    return block;
  };
  const auto with = [&](const std::string& motion) {
    const std::size_t begin = text.find("  interpolation:"), end = text.find("  force_N:");
    return parseScenario("d.yaml", text.substr(0, begin) + motion + text.substr(end), "r.yaml", robot).trajectory;
  };
  EXPECT_EQ(std::get<TipPath>(with(example("waypoints")).motion).waypoints.size(), 2u);
  const TrajectorySpec noisy_sine = with(example("sine") + example("noise"));
  EXPECT_EQ(std::get<JointSine>(noisy_sine.motion).end_s, 18.0);
  EXPECT_EQ(noisy_sine.noise->standard_deviation, JointVector(Vector3(0.1, 0.02, 0.02)));

  const Scenario limited = parseScenario("d.yaml", replaced(text, "# effort_limit:", "effort_limit:"), "r.yaml", robot);
  EXPECT_EQ(limited.robot.joints[1].effort_limit, 10.0);
  const std::string ramped =
      replaced(replaced(text, "# ramp:", "ramp:"), "interpolation: quintic", "interpolation: trapezoidal");
  EXPECT_EQ(std::get<JointPath>(parseScenario("d.yaml", ramped, "r.yaml", robot).trajectory.motion).timing.ramp, 0.25);
}

TEST(DeployedRobots, OfTheReportExplainEveryKey) {
  const std::string text = readYamlFile((deployFolder() / "robots/rpp.yaml").string());
  const std::vector<std::pair<std::string, std::string>> places{
      {"name: rpp ", "zzz: 1\nname: rpp "},
      {"base: {", "base: {zzz: 1, "},
      {"- name: shoulder", "- zzz: 1\n    name: shoulder"},
      {"mass_kg: 1.357", "zzz: 1\n      mass_kg: 1.357"},
      {"inertia_com_kg_m2: {xx: 0.0002", "inertia_com_kg_m2: {zzz: 1, xx: 0.0002"},
      {"# friction: {", "friction: {zzz: 1, "}};
  for (const auto& [from, to] : places) {
    const std::string changed = replaced(text, from, to);
    for (const std::string& key : knownKeys(refusal([&] { return parseRobot("r.yaml", changed); }))) {
      const bool is_explained = text.find(key + ":") != std::string::npos ||
                                text.find(" " + key + ",") != std::string::npos ||
                                text.find("(" + key + ")") != std::string::npos;
      EXPECT_TRUE(is_explained) << key;
    }
  }
}

}  // namespace
}  // namespace baton
