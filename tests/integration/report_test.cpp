// What is made of recordings: numbers, drawings, the page of figures.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

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
  const std::string page = readFile(fs::path(out) / "index.html");
  EXPECT_NE(page.find("agrees with theory"), std::string::npos);
  EXPECT_NE(page.find("What the report has wrong"), std::string::npos);

  // The second time nothing has to be run.
  const nlohmann::json again = bench.batonJson({"figures", "--only", "9", "--out", out, "--json"});
  EXPECT_EQ(again.at("reused"), again.at("runs"));
  EXPECT_EQ(again.at("figures"), made.at("figures"));
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
  const std::string page = readFile(out / "index.html");
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
}

}  // namespace
}  // namespace baton::test
