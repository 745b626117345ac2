// What is made of recordings: numbers, drawings, the page of figures.
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "runtime/paths.hpp"
#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

TEST(Report, MetricsOfARunAreThoseOfItsStates) {
  const Bench bench;
  const std::string recording = (bench.folder() / "short.mcap").string();
  ASSERT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", recording}).exit_code, 0);
  const nlohmann::json metrics = bench.batonJson({"metrics", recording, "--json"});
  EXPECT_EQ(metrics.at("steps"), kShortSteps);
  EXPECT_DOUBLE_EQ(metrics.at("duration_s"), 0.5);
  ASSERT_EQ(metrics.at("joints").size(), 3U);
  ASSERT_EQ(metrics.at("task").size(), 4U);
  for (const auto& row : metrics.at("joints")) {
    EXPECT_LE(std::abs(row.at("final").get<double>()), row.at("peak").get<double>());
    EXPECT_LE(row.at("rms").get<double>(), row.at("peak").get<double>());
  }
  // The tip stands in the wall at z = 0.66 m, where its force is the wall's: what it misses of z_d it presses with.
  const double z_error = metrics.at("task").at(2).at("final");
  const double force_N = metrics.at("force_N").at("final").at(2);
  EXPECT_NEAR(force_N, 200.0 * (0.725 - z_error - 0.66), 0.2) << "up to the damping of what still moves";
  EXPECT_EQ(bench.baton({"metrics", bench.write("text.mcap", "no recording")}).exit_code, 2);
  EXPECT_EQ(bench.baton({"metrics", (bench.folder() / "none.mcap").string()}).exit_code, 3);
}

TEST(Report, ShadowTellsWhatEachControllerWouldHaveDone) {
  const Bench bench;
  const std::string recording = (bench.folder() / "short.mcap").string(), out = (bench.folder() / "drawn").string();
  ASSERT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", recording}).exit_code, 0);
  const nlohmann::json shadow = bench.batonJson({"shadow", recording, "--out", out, "--json"});
  EXPECT_EQ(shadow.at("steps"), kShortSteps);
  EXPECT_EQ(shadow.at("standby"), "hot");
  EXPECT_EQ(shadow.at("cut"), "");
  ASSERT_EQ(shadow.at("controllers").size(), 4U);
  double held = 0.0;
  for (const auto& controller : shadow.at("controllers")) {
    held += controller.at("held").get<double>();
    ASSERT_EQ(controller.at("joints").size(), 3U);
    EXPECT_GT(controller.at("joints").at(0).at("largest"), 0.0) << controller;
  }
  EXPECT_DOUBLE_EQ(held, 1.0);
  EXPECT_DOUBLE_EQ(shadow.at("controllers").at(0).at("held"), 0.001 * kFirstSwap);
  EXPECT_NE(readFile(fs::path(out) / "short_shadow.svg").find("</svg>"), std::string::npos);

  // One that was cut off is read as far as it goes, and says so.
  fs::resize_file(recording, fs::file_size(recording) / 2);
  const nlohmann::json cut = bench.batonJson({"shadow", recording, "--json"});
  EXPECT_LT(cut.at("steps"), kShortSteps);
  EXPECT_NE(cut.at("cut"), "");
}

TEST(Report, ShadowSaysWhatAColdStandbyLeavesOut) {
  const Bench bench;
  const std::string recording = (bench.folder() / "cold.mcap").string();
  ASSERT_EQ(
      bench.baton({"run", bench.write("cold.yaml", shortContact("standby: cold\n")), "--out", recording}).exit_code, 0);
  const Finished text = bench.baton({"shadow", recording});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_NE(text.out.find("standby: cold"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("pd (joint_pd): held 0.0 %, without effort 100.0 %"), std::string::npos) << text.out;
}

TEST(Report, AFigureIsRunDrawnAndHeldAgainstTheory) {
  const Bench bench;
  const std::string out = (bench.folder() / "figures").string();
  const Finished first = bench.baton({"figures", "--only", "9", "--out", out, "--json"});
  ASSERT_EQ(first.exit_code, 0) << first.out << first.err;
  const nlohmann::json made = nlohmann::json::parse(first.out);
  EXPECT_EQ(made.at("reused"), 0);
  ASSERT_EQ(made.at("figures").size(), 1U);
  EXPECT_TRUE(made.at("figures").at(0).at("agrees"));
  EXPECT_FALSE(made.at("figures").at(0).at("checks").empty());
  std::size_t drawings = 0;
  for (const auto& entry : fs::directory_iterator(out)) {
    if (entry.path().extension() == ".svg") {
      ++drawings;
      EXPECT_NE(readFile(entry.path()).find("</svg>"), std::string::npos) << entry.path();
    }
    if (entry.path().extension() == ".png") {
      EXPECT_EQ(readFile(entry.path()).substr(1, 3), "PNG") << entry.path();
    }
  }
  EXPECT_GT(drawings, 0U);
  const std::string page = readFile(fs::path(out) / "partial.html");
  EXPECT_NE(page.find("agrees with theory"), std::string::npos);
  const std::size_t errata = page.find("What the report has wrong");
  ASSERT_NE(errata, std::string::npos);
  const std::string standings = page.substr(errata);
  EXPECT_NE(standings.find("what is right agrees with theory"), std::string::npos) << "the one that rests on Figure 9";
  EXPECT_EQ(standings.find("not established"), std::string::npos);
  EXPECT_NE(standings.find("not run"), std::string::npos) << "those that rest on others";
  EXPECT_EQ(made.at("page"), (fs::path(out) / "partial.html").string());
  EXPECT_FALSE(fs::exists(fs::path(out) / "index.html")) << "the page of all figures is another";

  // The second time nothing has to be run.
  const nlohmann::json again = bench.batonJson({"figures", "--only", "9", "--out", out, "--json"});
  EXPECT_EQ(again.at("reused"), again.at("runs"));
  EXPECT_EQ(again.at("figures"), made.at("figures"));
}

/// An installation with data that a test may change: the programs by hard links, so that they see it beside them.
fs::path installation(const Bench& bench) {
  fs::path root = bench.folder() / "installed";
  const fs::path data = root / "share/baton";
  fs::create_directories(root / "bin");
  fs::create_directories(data);
  for (const auto& program : fs::directory_iterator(programFolder())) {
    const fs::path link = root / "bin" / program.path().filename();
    std::error_code is_elsewhere;  // no link leads to another file system
    fs::create_hard_link(program, link, is_elsewhere);
    if (is_elsewhere) fs::copy_file(program, link);
  }
  for (const char* folder : {"scenarios", "robots", "figures"})
    fs::copy(deployFolder() / folder, data / folder, fs::copy_options::recursive);
  return root;
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  ASSERT_TRUE(stream << text);
}

TEST(Report, ABatchRunsWhatIsNotThereOrNotOfThisExperimentAndNothingElse) {
  Bench bench;
  const fs::path installed = installation(bench), baton = installed / "bin/baton";
  const fs::path out = bench.folder() / "figures", recordings = out / "recordings", page = out / "partial.html";
  const fs::path first = recordings / "fig24_operational_tracking.mcap", second = recordings / "fig24_cubic.mcap";
  const std::vector<std::string> arguments{
      "figures", "--only",     "24",     "--jobs",   "1",
      "--out",   out.string(), "--json", "--domain", std::to_string(bench.domain())};
  const auto scenarioOf = [&](const fs::path& recording) {
    return (installed / "share/baton/scenarios/report" / recording.stem()).replace_extension(".yaml");
  };
  std::map<fs::path, std::string> texts;
  for (const fs::path& recording : {first, second}) {  // shorter than the report's; theory holds all the same
    std::string& text = texts[recording] = readFile(scenarioOf(recording));
    const std::string duration = "duration_s: 8";
    ASSERT_NE(text.find(duration), std::string::npos);
    text.replace(text.find(duration), duration.size(), "duration_s: 5");
    write(scenarioOf(recording), text);
  }

  // The second run is so slow that it lasts until it is interrupted.
  write(scenarioOf(second), texts[second] + "rate: 0.001\n");
  int batch = bench.start(baton.string(), arguments, "first.log");
  ASSERT_TRUE(eventually([&] {
    const std::string cell = "figures-" + std::to_string(batch) + "-1";
    const Finished status = bench.baton({"status", "--cell", cell, "--json"});
    return status.exit_code == 0 && nlohmann::json::parse(status.out).at("state") == "running";
  }));
  ASSERT_EQ(kill(batch, SIGINT), 0);
  EXPECT_EQ(bench.wait(batch), 130) << readFile(bench.folder() / "first.log");
  EXPECT_TRUE(eventually([&] { return processesWith(installed.string()).empty(); }));
  ASSERT_TRUE(fs::exists(first));
  EXPECT_FALSE(fs::exists(second)) << "it would be taken for the run's recording";
  EXPECT_FALSE(fs::exists(page));
  const auto when_first_was_recorded = fs::last_write_time(first);

  // As a batch that was killed leaves it: whole as a recording, but not of the whole run. It is not used.
  fs::rename(recordings / "fig24_cubic.failed.mcap", second);
  EXPECT_EQ(runProgram(baton, {"bag", "info", second.string()}, bench.folder()).exit_code, 0);
  batch = bench.start(baton.string(), arguments, "second.log");
  ASSERT_TRUE(eventually([&] { return !processesWith(second.string()).empty(); }));
  ASSERT_EQ(kill(batch, SIGINT), 0);
  EXPECT_EQ(bench.wait(batch), 130) << readFile(bench.folder() / "second.log");
  EXPECT_EQ(fs::last_write_time(first), when_first_was_recorded);
  EXPECT_FALSE(fs::exists(page));

  const auto reused = [&] {
    const Finished finished = runProgram(baton, arguments, bench.folder());
    EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
    const nlohmann::json result = nlohmann::json::parse(finished.out);
    EXPECT_EQ(result.at("runs"), 2);
    EXPECT_TRUE(result.at("figures").at(0).at("agrees"));
    return result.at("reused").get<int>();
  };
  write(scenarioOf(second), texts[second]);
  EXPECT_EQ(reused(), 1) << "the first";
  EXPECT_EQ(fs::last_write_time(first), when_first_was_recorded);
  const std::string html = readFile(page);
  for (const auto& entry : fs::directory_iterator(out)) {
    if (entry.path().extension() != ".svg") continue;
    EXPECT_NE(html.find(entry.path().filename()), std::string::npos) << entry;
  }

  write(scenarioOf(first), texts[first] + "# changed\n");
  fs::resize_file(second, fs::file_size(second) / 2);
  EXPECT_EQ(reused(), 0) << "one of another text, one cut off";
  fs::remove(second);
  EXPECT_EQ(reused(), 1) << "the one that is there";
}

TEST(Report, TheStudyOfTheCouplingAgreesWithTheory) {
  const Bench bench;
  const fs::path out = bench.folder() / "figures";
  const Finished studied = bench.baton({"figures", "--only", "co-simulation", "--out", out.string(), "--json"});
  ASSERT_EQ(studied.exit_code, 0) << studied.out << studied.err;
  const nlohmann::json made = nlohmann::json::parse(studied.out);
  ASSERT_EQ(made.at("figures").size(), 3U);
  for (const auto& figure : made.at("figures")) {
    EXPECT_TRUE(figure.at("agrees")) << figure;
    EXPECT_GE(figure.at("checks").size(), 7U);
  }
  const std::string page = readFile(out / "partial.html");
  EXPECT_NE(page.find("Beyond the report"), std::string::npos);
  for (const char* chart : {"spring_derivatives_coupling_energy", "damped_spring_coupling_stability",
                            "arm_in_springs_coupling_error", "touch_coupling_error"}) {
    EXPECT_NE(page.find(std::string(chart) + ".svg"), std::string::npos) << chart;
    EXPECT_NE(readFile(out / (std::string(chart) + ".svg")).find("</svg>"), std::string::npos) << chart;
  }
}

TEST(Report, AFigureThatIsNotThereIsNamed) {
  const Bench bench;
  const Finished refused = bench.baton({"figures", "--only", "99", "--out", (bench.folder() / "figures").string()});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("99"), std::string::npos) << refused.err;
  EXPECT_EQ(refused.err.find("fixed gravity"), std::string::npos) << "a comma cannot be typed: " << refused.err;
}

}  // namespace
}  // namespace baton::test
