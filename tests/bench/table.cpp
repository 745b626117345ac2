#include "bench/table.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <ostream>

#include "bench/statistics.hpp"

namespace baton::bench {
namespace {

constexpr const char* kBaton = "Baton";
constexpr const char* kKdl = "orocos-kdl";
constexpr const char* kMujoco = "MuJoCo";
constexpr const char* kYardstick = "inverse dynamics";  // what a law costs at least, if it knows the arm

/// Largest ratio to Orocos KDL that is good enough.
const std::map<std::string, double>& targets() {
  static const std::map<std::string, double> ratios = {
      {"inverse dynamics", 0.6}, {"mass matrix", 0.3}, {"forward dynamics", 0.5}};
  return ratios;
}

void printCell(std::ostream& out, double value, int decimals) {
  out << std::setw(12);
  if (std::isfinite(value)) {
    out << std::fixed << std::setprecision(decimals) << value;
  } else {
    out << "-";
  }
}

void printHeading(std::ostream& out, const std::string& arm) {
  out << "\n" << std::left << std::setw(44) << arm << std::right;
  for (const char* column : {kBaton, kKdl, kMujoco}) out << std::setw(12) << column;
  out << std::setw(12) << "/ KDL" << std::setw(12) << "/ MuJoCo" << std::setw(12) << "/ inv. dyn."
      << "\n";
}

}  // namespace

void Table::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.run_type != Run::RT_Iteration) continue;  // an aggregate
    const std::string& name = run.run_name.function_name;
    order_[run.family_index] = name;
    times_ns_[name].push_back(1e9 * run.cpu_accumulated_time / static_cast<double>(run.iterations));
  }
}

double Table::median(const std::string& arm, const std::string& quantity, const std::string& who) const {
  const auto found = times_ns_.find(arm + "/" + quantity + "/" + who);
  if (found == times_ns_.end()) return std::numeric_limits<double>::quiet_NaN();
  return bench::median(found->second);
}

std::vector<Table::Arm> Table::arms() const {
  std::vector<Arm> arms;
  for (const auto& [index, name] : order_) {
    const std::size_t first = name.find('/'), last = name.rfind('/');
    const std::string arm = name.substr(0, first), quantity = name.substr(first + 1, last - first - 1);
    auto found = std::find_if(arms.begin(), arms.end(), [&](const Arm& known) { return known.name == arm; });
    if (found == arms.end()) found = arms.insert(arms.end(), Arm{arm, {}});
    auto& quantities = found->quantities;
    if (std::find(quantities.begin(), quantities.end(), quantity) == quantities.end()) quantities.push_back(quantity);
  }
  return arms;
}

bool Table::print(std::ostream& out) const {
  bool is_good = true;
  for (const auto& [arm, quantities] : arms()) {
    printHeading(out, arm);
    for (const std::string& quantity : quantities) {
      const double ours = median(arm, quantity, kBaton), kdl = median(arm, quantity, kKdl),
                   mujoco = median(arm, quantity, kMujoco), yardstick = median(arm, kYardstick, kBaton);
      out << "  " << std::left << std::setw(42) << quantity << std::right;
      for (const double time_ns : {ours, kdl, mujoco}) printCell(out, time_ns, 0);
      for (const double other : {kdl, mujoco, yardstick}) printCell(out, ours / other, 2);

      const auto target = targets().find(quantity);
      if (target != targets().end() && std::isfinite(ours / kdl)) {
        const bool is_met = ours / kdl <= target->second;
        is_good = is_good && is_met;
        out << (is_met ? "   met: " : "   MISSED: ") << target->second << " of KDL";
      }
      out << "\n";
    }
  }
  return is_good;
}

}  // namespace baton::bench
