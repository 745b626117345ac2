/// The table of a bench: one figure a row, beside what is aimed at where something is.
#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace baton::bench {

struct Row {
  std::string name;
  double value = 0.0;
  std::string unit;
  std::optional<double> target{};
  bool is_less_better = false;
  [[nodiscard]] bool isReached() const { return !target || (is_less_better ? value <= *target : value >= *target); }
};

void print(std::FILE* out, const Row& row);
/// [{"name", "value", "unit", "target", "reached"}]; null where nothing is aimed at.
[[nodiscard]] nlohmann::ordered_json toJson(const std::vector<Row>& rows);

}  // namespace baton::bench
