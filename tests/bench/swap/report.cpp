#include "report.hpp"

#include <unistd.h>

#include <algorithm>
#include <iomanip>
#include <ostream>

#include "bench/statistics.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;

constexpr double kEffect_ms = 5.0;          // in real time at 1 kHz, of 99 in 100
constexpr std::uint64_t kBesideMargin = 2;  // steps, in lockstep, of all

template <class T>
Json spread(std::vector<T> values) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  return {{"p50", quantile(values, 0.5)}, {"p99", quantile(values, 0.99)}, {"max", quantile(values, 1.0)}};
}

/// From microseconds.
Json spreadOf(const nlohmann::json& spread_us) {
  if (spread_us.is_null()) return nullptr;
  Json spread;
  for (const char* key : {"p50", "p99", "max"}) spread[key] = spread_us.at(key).get<double>() * 1e-3;
  return spread;
}

Json target(const char* quantity, const char* key, const Json& spread, double at_most, bool is_below) {
  if (spread.is_null()) return {{"quantity", quantity}, {"at_most", at_most}, {"value", nullptr}, {"reached", nullptr}};
  const double value = spread.at(key);
  return {{"quantity", quantity},
          {"at_most", at_most},
          {"value", value},
          {"reached", is_below ? value < at_most : value <= at_most}};
}

Json toJson(const SwapCase& one, const Handovers& made) {
  const Json effect = spread(made.asked_to_effect_ms), steps = spread(made.steps);
  return {{"name", one.name},
          {"step_ms", made.step_s * 1e3},
          {"margin_steps", made.margin_steps},
          {"done", made.steps.size()},
          {"refused", made.refused},
          {"refusal", made.refusal},
          {"lost", made.lost},
          {"missed_steps", made.timing.at("missed")},
          {"asked_to_effect_ms", effect},
          {"decided_to_effect_ms", spreadOf(made.timing.at("handover_us"))},
          {"steps", steps},
          {"target", one.is_realtime ? target("p99 from asked to effect [ms]", "p99", effect, kEffect_ms, true)
                                     : target("steps from decided to effect, all", "max", steps,
                                              static_cast<double>(made.margin_steps + kBesideMargin), false)}};
}

void line(std::ostream& out, const char* name, const Json& spread, int decimals) {
  out << "  " << std::left << std::setw(34) << name << std::right << std::fixed << std::setprecision(decimals);
  for (const char* key : {"p50", "p99", "max"}) {
    out << std::setw(10);
    if (spread.is_null()) {
      out << "-";
    } else {
      out << spread.at(key).get<double>();
    }
  }
  out << "\n";
}

}  // namespace

Json toJson(int swaps, const SwapResults& results) {
  Json cases = Json::array();
  for (const auto& [one, made] : results) cases.push_back(toJson(one, made));
  return {{"swaps", swaps}, {"cores", sysconf(_SC_NPROCESSORS_ONLN)}, {"cases", cases}};
}

void printTable(const Json& report, std::ostream& out) {
  out << "Handovers of the scenario lab, " << report.at("swaps") << " asked for in each case, on " << report.at("cores")
      << " cores\n";
  for (const Json& one : report.at("cases")) {
    out << "\n"
        << one.at("name").get<std::string>() << ", steps of " << one.at("step_ms") << " ms, margin "
        << one.at("margin_steps") << " steps: " << one.at("done") << " done, " << one.at("refused") << " refused";
    if (one.at("refused") > 0) out << " (" << one.at("refusal").get<std::string>() << ")";
    out << ", " << one.at("missed_steps") << " steps missed, the baton lost " << one.at("lost") << " times\n  "
        << std::left << std::setw(34) << "" << std::right;
    for (const char* heading : {"p50", "p99", "max"}) out << std::setw(10) << heading;
    out << "\n";
    line(out, "asked to effect [ms]", one.at("asked_to_effect_ms"), 3);
    line(out, "decided to effect [ms]", one.at("decided_to_effect_ms"), 3);
    line(out, "decided to effect [steps]", one.at("steps"), 0);
    const Json& target = one.at("target");
    out << "  " << target.at("quantity").get<std::string>() << ": ";
    if (target.at("reached").is_null()) {
      out << "not measured\n";
    } else {
      out << std::setprecision(3) << target.at("value").get<double>() << ", aimed at "
          << target.at("at_most").get<double>() << (target.at("reached").get<bool>() ? ": reached\n" : ": MISSED\n");
    }
  }
}

}  // namespace baton::bench
