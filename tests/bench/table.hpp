/// The result of a run as one table: medians over the repetitions, and what they are to one another.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace baton::bench {

/// Collects while Google Benchmark runs; see cases.hpp for the names it goes by.
class Table : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override;

  /// Returns false when a ratio misses its target.
  [[nodiscard]] bool print(std::ostream& out) const;

 private:
  struct Arm {
    std::string name;
    std::vector<std::string> quantities;
  };
  /// What was run, in the order in which it was registered.
  [[nodiscard]] std::vector<Arm> arms() const;

  /// Median time of a call [ns]; NaN for what was not run.
  [[nodiscard]] double median(const std::string& arm, const std::string& quantity, const std::string& who) const;

  std::map<std::string, std::vector<double>> times_ns_;  // processor time of a call, each repetition, by name
  std::map<std::int64_t, std::string> order_;            // names by index of registration
};

}  // namespace baton::bench
