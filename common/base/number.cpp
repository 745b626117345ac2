#include "base/number.hpp"

namespace baton {

std::string commaHint(std::string_view text) {
  std::string with_point(text);
  const std::size_t comma = with_point.find(',');
  if (comma == std::string::npos) return "";
  with_point[comma] = '.';
  return numberIn<double>(with_point) ? "; the decimal sign is a point: " + with_point : "";
}

}  // namespace baton
