// The benches of the loop, of the recording and of the recorder: that they measure. What it measures is the machine's
// business.
#include <gtest/gtest.h>

#include "support/processes.hpp"

namespace baton::test {
namespace {

TEST(LoopBench, MeasuresBatonBesideTheRawChainAndSeveralCellsAtOnce) {
  const Bench bench;
  const Finished finished = runProgram(programFolder() / "baton-bench",
                                       {"--rounds", "1", "--steps", "300", "--json", "--only", "raw-3-hops", "force",
                                        "raw-3-hops-observed", "force-recorded", "in-process", "cells-2"},
                                       bench.folder());
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const nlohmann::json report = nlohmann::json::parse(finished.out);

  ASSERT_EQ(report.at("cases").size(), 6U);
  std::map<std::string, double> p50_us;
  for (const auto& one : report.at("cases")) {
    SCOPED_TRACE(one.dump());
    const int with_recorder = one.at("recorded").get<bool>() ? 1 : 0;
    EXPECT_EQ(one.at("processes"), one.at("transport") == "none" ? 1 : 4 * one.at("cells").get<int>() + with_recorder);
    p50_us[one.at("name")] = one.at("p50_us").at("median");
    EXPECT_GT(one.at("p50_us").at("median"), 0.0);
    EXPECT_LE(one.at("p50_us").at("median"), one.at("p99_us").at("median"));
    EXPECT_GT(one.at("steps_per_s").at("median"), 0.0);
  }
  int measured = 0;
  for (const auto& one : report.at("comparisons")) {
    SCOPED_TRACE(one.dump());
    const auto of = p50_us.find(one.at("of")), against = p50_us.find(one.at("against"));
    if (of == p50_us.end() || against == p50_us.end()) {
      EXPECT_TRUE(one.at("ratio").is_null());
      EXPECT_TRUE(one.at("reached").is_null());
      continue;
    }
    ++measured;
    const double ratio = of->second / against->second;
    EXPECT_DOUBLE_EQ(one.at("ratio").at("median").get<double>(), ratio);
    EXPECT_EQ(one.at("reached").is_null(), one.at("target").is_null());
    if (one.at("target").is_null()) continue;
    EXPECT_EQ(one.at("reached").get<bool>(), ratio <= one.at("target").get<double>());
  }
  EXPECT_EQ(measured, 4);
  EXPECT_GT(report.at("resident_MB").at("plant"), 0.0);
  EXPECT_GT(report.at("resident_MB").at("recorder"), 0.0);
  EXPECT_NE(finished.err.find("raw-3-hops"), std::string::npos) << finished.err;  // the table
}

TEST(LoopBench, NamesItsCasesWhenOneIsUnknown) {
  const Bench bench;
  const Finished finished = runProgram(programFolder() / "baton-bench", {"--only", "nonsense"}, bench.folder());
  EXPECT_EQ(finished.exit_code, 2) << finished.err;
  EXPECT_NE(finished.err.find("force-recorded"), std::string::npos) << finished.err;
}

TEST(SwapBench, MeasuresHandoversInBothModes) {
  const Bench bench;
  const Finished finished =
      runProgram(programFolder() / "baton-bench-swap", {"--swaps", "6", "--json"}, bench.folder());
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const nlohmann::json report = nlohmann::json::parse(finished.out);
  ASSERT_EQ(report.at("cases").size(), 2U);
  for (const auto& one : report.at("cases")) {
    SCOPED_TRACE(one.dump());
    const bool is_realtime = one.at("name") == "realtime";
    EXPECT_EQ(one.at("done").get<int>() + one.at("refused").get<int>(), 6);
    // On a busy machine a holder may lose the baton while it is asked for; in lockstep nothing can go wrong.
    if (is_realtime && one.at("done") == 0) continue;
    EXPECT_GE(one.at("steps").at("p50"), one.at("margin_steps"));
    for (const char* times : {"asked_to_effect_ms", "decided_to_effect_ms"}) {
      EXPECT_GT(one.at(times).at("p50"), 0.0) << times;
      EXPECT_LE(one.at(times).at("p50"), one.at(times).at("max")) << times;
    }
    const nlohmann::json& target = one.at("target");
    if (is_realtime) {
      EXPECT_EQ(target.at("reached"), target.at("value") < target.at("at_most"));
      continue;
    }
    EXPECT_EQ(one.at("refused"), 0);
    EXPECT_LE(one.at("steps").at("max"), one.at("margin_steps").get<int>() + 2);
    EXPECT_TRUE(target.at("reached"));
  }
  EXPECT_NE(finished.err.find("asked to effect"), std::string::npos) << finished.err;  // the table
}

TEST(RestBench, MeasuresCellsThatArePaused) {
  const Bench bench;
  const Finished finished =
      runProgram(programFolder() / "baton-bench-rest", {"--cells", "2", "--seconds", "1", "--json"}, bench.folder());
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const nlohmann::json report = nlohmann::json::parse(finished.out);
  EXPECT_EQ(report.at("processes"), 2 * 7) << "the supervisor and six services each";
  EXPECT_GT(report.at("started_s"), 0.0);
  EXPECT_GE(report.at("cpu_cores"), 0.0);
  EXPECT_GT(report.at("beside_startup_s"), 0.0);
}

TEST(RecordingBench, MeasuresWriterAndReader) {
  const Bench bench;
  const Finished finished = runProgram(
      programFolder() / "baton-bench-recording",
      {"--size", "10", "--written", "1", "--rounds", "1", "--disk", bench.folder().string(), "--json"}, bench.folder());
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const nlohmann::json rows = nlohmann::json::parse(finished.out);
  EXPECT_GE(rows.size(), 25U);
  int targets = 0;
  for (const auto& row : rows) {
    SCOPED_TRACE(row.dump());
    EXPECT_TRUE(row.at("value").is_number());
    EXPECT_EQ(row.at("target").is_null(), row.at("reached").is_null());
    if (!row.at("target").is_null()) ++targets;
  }
  EXPECT_GE(targets, 14);
  for (const auto& entry : std::filesystem::directory_iterator(bench.folder())) {
    EXPECT_FALSE(entry.is_directory()) << entry.path() << " is left lying about";
  }
}

TEST(RecorderBench, CountsWhatEachWriterSentAndWhatOfItIsInTheFile) {
  const Bench bench;
  const Finished finished = runProgram(programFolder() / "baton-bench-recorder",
                                       {"--writers", "3", "--rate", "1800", "--up-to", "2400", "--seconds", "0.5",
                                        "--steps", "300", "--rounds", "2", "--disk", bench.folder().string(), "--json"},
                                       bench.folder());
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const nlohmann::json report = nlohmann::json::parse(finished.out);
  ASSERT_EQ(report.at("rounds").size(), 2U);
  std::uint64_t sent = 0, lost = 0;  // at the rate that was asked for
  for (const auto& round : report.at("rounds")) {
    ASSERT_FALSE(round.at("measured").empty());
    for (const auto& one : round.at("measured")) {
      SCOPED_TRACE(one.dump());
      ASSERT_EQ(one.at("writers").size(), 3U);
      std::uint64_t difference = 0;
      for (const auto& writer : one.at("writers")) {
        EXPECT_EQ(writer.at("sent"), static_cast<std::uint64_t>(one.at("asked_per_s").get<double>() * 0.5 / 3.0));
        EXPECT_LE(writer.at("recorded"), writer.at("sent"));
        difference += writer.at("sent").get<std::uint64_t>() - writer.at("recorded").get<std::uint64_t>();
      }
      EXPECT_EQ(one.at("lost"), difference);
      EXPECT_EQ(one.at("complete"), difference == 0) << "the certificate sees what the count sees";
      EXPECT_GT(one.at("sent_per_s"), 0.0);
    }
    const auto& first = round.at("measured").front();
    EXPECT_EQ(first.at("asked_per_s"), 1800.0);
    sent += 3 * first.at("writers").front().at("sent").get<std::uint64_t>();
    lost += first.at("lost").get<std::uint64_t>();
  }
  std::map<std::string, double> values;
  for (const auto& row : report.at("rows")) {
    SCOPED_TRACE(row.dump());
    EXPECT_EQ(row.at("target").is_null(), row.at("reached").is_null());
    values[row.at("name")] = row.at("value");
  }
  EXPECT_EQ(sent, 1800U);
  EXPECT_EQ(values.at("sent at 1800/s, all rounds"), sent);
  EXPECT_EQ(values.at("recorded at 1800/s, all rounds"), sent - lost);
  EXPECT_EQ(values.at("lost at 1800/s, all rounds"), lost);
  for (const char* sync : {"none", "1", "0.1", "chunk"}) EXPECT_GT(values.at(std::string("run, sync ") + sync), 0.0);
  EXPECT_GT(values.at("run, sync chunk / sync none"), 0.0);
  EXPECT_NE(finished.err.find("highest rate without a loss"), std::string::npos) << finished.err;  // the table
}

TEST(RawChain, PassesEveryStepInBothOrders) {
  const Bench bench;
  for (const char* hops : {"2", "3"}) {
    const Finished finished =
        runProgram(programFolder() / "baton-raw-chain",
                   {"--hops", hops, "--steps", "200", "--warm-up", "20", "--domain", std::to_string(bench.domain())},
                   bench.folder());
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    EXPECT_EQ(nlohmann::json::parse(finished.out).at("period_us").at("count"), 200);
  }
}

}  // namespace
}  // namespace baton::test
