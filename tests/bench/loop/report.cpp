#include "report.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/statistics.hpp"
#include "runtime/platform.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;
using Value = double Measurement::*;

/// One case's p50 held against another's, round by round.
struct Comparison {
  const char* name;
  const char* of;
  const char* against;
  std::optional<double> target;  // at most; none: for information
};

const std::vector<Comparison>& comparisons() {
  static const std::vector<Comparison> all{
      {"law with force, 3 hops", "force", "raw-3-hops", 1.10},
      {"law without force, 2 hops", "motion", "raw-3-hops", 0.90},
      {"the same beside 2 raw hops", "motion", "raw-2-hops", std::nullopt},
      {"shared memory", "force-shm", "raw-3-hops", 0.85},
      {"the same beside raw shared memory", "force-shm", "raw-3-hops-shm", std::nullopt},
      {"recorder, law with force", "force-recorded", "force", 1.20},
      {"recorder, law without force", "motion-recorded", "motion", 1.20},
      {"the first beside a raw chain that is read", "force-recorded", "raw-3-hops-observed", std::nullopt},
      {"3 standbys, 10 % each", "force-3-standby", "force", 1.30},
      {"6 standbys, 10 % each", "force-6-standby", "force", 1.60},
      {"all in one process", "in-process", "force", std::nullopt},
  };
  return all;
}

constexpr const char* kEightProcesses = "force-3-standby-recorded";
constexpr double kStart_s = 1.5;
constexpr double kResident_MB = 25.0;

/// NaN cannot be written as JSON.
Json orNull(double value) { return std::isnan(value) ? Json(nullptr) : Json(value); }

Json spread(const std::vector<Measurement>& rounds, Value value) {
  std::vector<double> values;
  values.reserve(rounds.size());
  for (const Measurement& round : rounds) values.push_back(round.*value);
  if (std::isnan(median(values))) return nullptr;
  return {{"median", median(values)}, {"rounds", values}};
}

Json casesJson(const Plan& plan, const Results& results) {
  Json cases = Json::array();
  for (const Case& one : plan.cases) {
    const auto found = results.find(one.name);
    const std::vector<Measurement> rounds = found == results.end() ? std::vector<Measurement>{} : found->second;
    cases.push_back({{"name", one.name},
                     {"hops", one.hops()},
                     {"transport", one.kind == Case::Kind::kInProcess ? "none"
                                   : one.shared_memory                ? "shm"
                                                                      : "udp"},
                     {"recorded", one.recorded},
                     {"standbys", one.standbys},
                     {"cells", one.cells},
                     {"processes", one.processes()},
                     {"p50_us", spread(rounds, &Measurement::p50_us)},
                     {"p99_us", spread(rounds, &Measurement::p99_us)},
                     {"steps_per_s", spread(rounds, &Measurement::steps_per_s)},
                     {"startup_s", spread(rounds, &Measurement::startup_s)}});
  }
  return cases;
}

Json comparisonsJson(const Results& results) {
  Json all = Json::array();
  for (const Comparison& one : comparisons()) {
    const auto of = results.find(one.of);
    const auto against = results.find(one.against);
    std::vector<double> ratios;
    if (of != results.end() && against != results.end()) {
      for (std::size_t round = 0; round < std::min(of->second.size(), against->second.size()); ++round) {
        ratios.push_back(of->second[round].p50_us / against->second[round].p50_us);
      }
    }
    const double ratio = median(ratios);
    all.push_back({{"name", one.name},
                   {"of", one.of},
                   {"against", one.against},
                   {"ratio", std::isnan(ratio) ? Json(nullptr) : Json{{"median", ratio}, {"rounds", ratios}}},
                   {"target", one.target ? Json(*one.target) : Json(nullptr)},
                   {"reached", one.target && !std::isnan(ratio) ? Json(ratio <= *one.target) : Json(nullptr)}});
  }
  return all;
}

/// By process: the median over the rounds of the case in which it needs most.
std::map<std::string, double> residentMemory(const Results& results) {
  std::map<std::string, double> largest;
  for (const auto& [name, rounds] : results) {
    std::map<std::string, std::vector<double>> by_process;
    for (const Measurement& round : rounds) {
      for (const auto& [process, megabytes] : round.resident_MB) by_process[process].push_back(megabytes);
    }
    for (const auto& [process, megabytes] : by_process) {
      largest[process] = std::max(largest[process], median(megabytes));
    }
  }
  return largest;
}

Json limit(const char* name, const char* unit, double value, double target) {
  return {{"name", name},
          {"unit", unit},
          {"value", orNull(value)},
          {"target", target},
          {"reached", std::isnan(value) ? Json(nullptr) : Json(value < target)}};
}

}  // namespace

Json toJson(const Plan& plan, const Results& results) {
  const std::map<std::string, double> resident_MB = residentMemory(results);
  double largest_MB = kUnknown;
  for (const auto& [process, megabytes] : resident_MB) largest_MB = std::fmax(largest_MB, megabytes);
  std::vector<double> starts_s;
  if (const auto eight = results.find(kEightProcesses); eight != results.end()) {
    for (const Measurement& round : eight->second) starts_s.push_back(round.startup_s);
  }
  return {{"rounds", plan.rounds},
          {"steps", plan.steps},
          {"machine", {{"processor", processorName()}, {"cores", sysconf(_SC_NPROCESSORS_ONLN)}}},
          {"build", BATON_COMPILER ", " BATON_FLAGS},
          {"cases", casesJson(plan, results)},
          {"resident_MB", resident_MB},
          {"comparisons", comparisonsJson(results)},
          {"limits",
           {limit("start of 8 processes, from the first launch to step 0", "s", median(starts_s), kStart_s),
            limit("memory of the largest process", "MB", largest_MB, kResident_MB)}}};
}

}  // namespace baton::bench
