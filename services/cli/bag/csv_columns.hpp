/// The columns of a table of messages of one type: one for each number, string or enum, sequences and arrays element by
/// element, with as many as the longest message has.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "schema/message_reader.hpp"

namespace baton {

/// A field as RFC 4180 has it: in quotes where it needs them.
[[nodiscard]] std::string csvField(const std::string& text);

class CsvColumns {
 public:
  /// A table of more is of no use to anybody.
  static constexpr std::size_t kMax = 16'384;

  explicit CsvColumns(const schema::Type& type);

  /// Makes room for a message. Throws schema::PayloadError when it is none of the type, UsageError for more than kMax
  /// columns.
  void fit(schema::Bytes payload);
  /// Numbers the columns, in the order of the type. fit() is over then. Returns their names: "tip_position[2] [m]".
  [[nodiscard]] std::vector<std::string> finish();
  /// A message's cells, by column; empty where it has nothing. Throws schema::PayloadError.
  /// @param[out] cells  cleared and filled, even when it throws.
  void fill(schema::Bytes payload, std::vector<std::string>& cells) const;

 private:
  /// What a message has at one place. `children` are a struct's or union's members, a sequence's or array's elements.
  struct Place {
    const schema::Type* type = nullptr;
    std::string unit;
    std::size_t column = 0;  // of a value
    std::vector<Place> children{};
  };

  [[nodiscard]] Place placeOf(const schema::Type& type, const std::string& unit);
  void name(Place& place, const std::string& path, std::vector<std::string>& names);

  std::size_t places_ = 0;
  std::size_t columns_ = 0;
  Place root_;
};

}  // namespace baton
