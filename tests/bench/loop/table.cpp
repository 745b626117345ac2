// The report for a person.
#include <iomanip>
#include <ostream>

#include "report.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;

constexpr int kNameWidth = 44;

struct Cell {
  const Json& value;  // a number, null, or a spread, of which the median is shown
  int decimals;
};

std::ostream& operator<<(std::ostream& out, const Cell& cell) {
  const Json& number = cell.value.is_object() ? cell.value.at("median") : cell.value;
  out << std::setw(12) << std::right;
  if (number.is_null()) return out << "-";
  return out << std::fixed << std::setprecision(cell.decimals) << number.get<double>();
}

void name(std::ostream& out, const std::string& text) { out << std::left << std::setw(kNameWidth) << text; }

void verdict(std::ostream& out, const Json& row) {
  if (row.at("reached").is_null()) return;
  out << (row.at("reached").get<bool>() ? "   reached" : "   MISSED");
}

}  // namespace

void printTable(const Json& report, std::ostream& out) {
  out << "Steps of the loop, " << report.at("rounds") << " interleaved rounds of " << report.at("steps") << " steps on "
      << report.at("machine").at("cores") << " cores; medians over the rounds\n\n";
  name(out, "case");
  for (const char* heading : {"processes", "p50 us", "p99 us", "steps/s"})
    out << std::right << std::setw(12) << heading;
  out << "\n";
  for (const Json& one : report.at("cases")) {
    name(out, one.at("name"));
    out << Cell{one.at("processes"), 0} << Cell{one.at("p50_us"), 1} << Cell{one.at("p99_us"), 1}
        << Cell{one.at("steps_per_s"), 0} << "\n";
  }

  out << "\n";
  name(out, "p50 against another's, round by round");
  for (const char* heading : {"ratio", "target"}) out << std::right << std::setw(12) << heading;
  out << "\n";
  for (const Json& one : report.at("comparisons")) {
    name(out, one.at("name"));
    out << Cell{one.at("ratio"), 2} << Cell{one.at("target"), 2};
    verdict(out, one);
    out << "\n";
  }

  out << "\n";
  for (const Json& one : report.at("limits")) {
    name(out, one.at("name").get<std::string>() + " [" + one.at("unit").get<std::string>() + "]");
    out << Cell{one.at("value"), 2} << Cell{one.at("target"), 2};
    verdict(out, one);
    out << "\n";
  }
  for (const auto& [process, megabytes] : report.at("resident_MB").items()) {
    name(out, "  " + process);
    out << Cell{megabytes, 1} << "\n";
  }
}

}  // namespace baton::bench
