/// A run started with `baton up`, to be disturbed while it lives.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/processes.hpp"

namespace baton::test {

struct LiveRun {
  LiveRun(const Bench& bench_in, const std::string& scenario, const std::vector<std::string>& options = {})
      : bench(bench_in) {
    recording = (bench.folder() / "live.mcap").string();
    std::vector<std::string> arguments{"up", bench.write("live.yaml", scenario), "--out", recording};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Finished up = bench.baton(arguments);
    EXPECT_EQ(up.exit_code, 0) << up.out << up.err;
    // On a busy machine not every service has spoken when the command ends that asks for their status.
    EXPECT_TRUE(eventually([&] {
      status = bench.batonJson({"status", "--json"});
      return std::ranges::all_of(status.at("services"), [](const auto& one) { return one.at("pid").is_number(); });
    }));
  }
  /// Throws where there is none: the number would be that of all processes.
  [[nodiscard]] int pidOf(const std::string& service) const {
    for (const auto& one : status.at("services")) {
      if (one.at("name") == service) return one.at("pid");
    }
    throw std::runtime_error("no service " + service + ": " + status.dump());
  }
  void waitForStep(std::uint64_t step) const {
    EXPECT_TRUE(eventually([&] { return bench.batonJson({"status", "--json"}).at("step") >= step; }));
  }
  /// Waits for another process of that service to be ready.
  void waitForSuccessor(const std::string& service, int before) const {
    EXPECT_TRUE(eventually([&] {
      const nlohmann::json now = bench.batonJson({"status", "--json"});
      for (const auto& one : now.at("services")) {
        if (one.at("name") == service && one.at("pid") != before && one.at("state") == "ready") return true;
      }
      return false;
    }));
  }
  [[nodiscard]] std::filesystem::path folder() const {
    return bench.folder() / "runs" / status.at("run").get<std::string>();
  }
  /// Waits for the run to be over and returns its result.
  [[nodiscard]] nlohmann::json result() const {
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(folder() / "result.json"); }));
    EXPECT_TRUE(eventually([&] { return processesWith(bench.folder().string()).empty(); }));
    return nlohmann::json::parse(std::ifstream(folder() / "result.json"));
  }

  const Bench& bench;
  std::string recording;
  nlohmann::json status;
};

}  // namespace baton::test
