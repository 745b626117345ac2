/// Suggestions for names that were mistyped.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace baton {

/// Number of single-character insertions, deletions and substitutions between two words (Levenshtein).
[[nodiscard]] inline std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// "; did you mean 'nearest'?"; empty when none is near. The beginning of a name is nearer than any other word.
[[nodiscard]] inline std::string didYouMean(const std::string& found, const std::vector<std::string>& known) {
  const auto distance = [&](const std::string& name) {
    return found.size() > 1 && name.starts_with(found) ? 0 : editDistance(found, name);
  };
  const auto nearest = std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
    return distance(a) < distance(b);
  });
  // Beyond half the word a suggestion would be a guess.
  const bool is_near = nearest != known.end() && distance(*nearest) <= std::max<std::size_t>(1, nearest->size() / 2);
  return is_near ? "; did you mean '" + *nearest + "'?" : "";
}

/// "unknown <kind> 'found'; did you mean 'nearest'? Known: a, b, c". Known names as given, in their order.
[[nodiscard]] inline std::string unknownName(std::string_view kind, const std::string& found,
                                             const std::vector<std::string>& known) {
  std::string message = "unknown " + std::string(kind) + " '" + found + "'";
  if (known.empty()) return message + "; there are none";
  const std::string suggestion = didYouMean(found, known);
  message += suggestion.empty() ? "; known:" : suggestion + " Known:";
  for (const std::string& name : known) message += (&name == &known.front() ? " " : ", ") + name;
  return message;
}

}  // namespace baton
