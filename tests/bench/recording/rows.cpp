#include "rows.hpp"

namespace baton::bench {

void print(std::FILE* out, const Row& row) {
  std::fprintf(out, "%-44s %12.*f %-10s", row.name.c_str(), row.value < 100.0 ? 2 : 0, row.value, row.unit.c_str());
  if (row.target) {
    std::fprintf(out, " %s %-9.0f %s", row.is_less_better ? "<=" : ">=", *row.target,
                 row.isReached() ? "reached" : "MISSED");
  }
  std::fprintf(out, "\n");
  std::fflush(out);
}

nlohmann::ordered_json toJson(const std::vector<Row>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    json.push_back(
        {{"name", row.name}, {"value", row.value}, {"unit", row.unit}, {"target", nullptr}, {"reached", nullptr}});
    if (row.target) json.back()["target"] = *row.target, json.back()["reached"] = row.isReached();
  }
  return json;
}

}  // namespace baton::bench
