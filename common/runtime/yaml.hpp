/// Strict reading of YAML files written by people. A file comes from outside, so every value is asked for by type, size
/// and range, keys nobody knows are refused, and each message says where, what was expected and what was found:
///
///   arm.yaml:12: joints[0].link.mass_kg: expected a number from 0 to 1000 kg, found 'heavy'
///
/// Numbers may be multiples of pi: pi, -pi/6, 2*pi/3. One document per file; no anchors, aliases or tags. All errors
/// are UsageErrors. Not a general YAML library: yaml-cpp parses, this keeps the result and says what it means.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/types.hpp"

namespace baton {

inline constexpr std::size_t kMaxYamlBytes = 1 << 20;  // a file larger than this is not one that a person wrote
inline constexpr int kMaxYamlDepth = 16;               // lists and maps within each other

/// What a number must be: minimum <= x <= maximum, or minimum < x when `open`. The unit is for messages.
struct NumberRange {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  std::string unit;
  bool open = false;

  /// "a number from 0 to 10 kg".
  [[nodiscard]] std::string text() const;
};

/// What services, controllers and the like may be called.
inline constexpr const char* kNameRule =
    "a name of 1 to 31 characters out of A-Z a-z 0-9 _ - that does not begin with -";
[[nodiscard]] bool isName(const std::string& text);

class YamlMap;

/// A value and its place in a document. Cheap to copy; keeps the document alive.
class YamlNode {
 public:
  /// The root of a document. `file` is only a name for messages.
  [[nodiscard]] static YamlNode parse(const std::string& file, const std::string& text);

  [[nodiscard]] double number(const NumberRange& range = {}) const;
  [[nodiscard]] std::int64_t integer(std::int64_t minimum, std::int64_t maximum) const;
  [[nodiscard]] bool boolean() const;
  /// A single value as it is written, quoted or not; at most `max_length` bytes.
  [[nodiscard]] std::string text(std::size_t max_length = 1000) const;
  /// A name that can travel in messages, file names and command lines: 1 to 31 of [A-Za-z0-9_-], no '-' first.
  [[nodiscard]] std::string name() const;
  /// One word out of a few, as the value that stands beside it.
  template <typename T>
  [[nodiscard]] T oneOf(const std::vector<std::pair<std::string, T>>& choices) const {
    std::vector<std::string> words;
    words.reserve(choices.size());
    for (const auto& choice : choices) words.push_back(choice.first);
    return choices[indexOfWord(words)].second;
  }

  /// A list of `size` numbers, each within the range; `each` says in messages what one number stands for ("joint").
  [[nodiscard]] std::vector<double> numbers(std::size_t size, const NumberRange& range = {},
                                            const std::string& each = "") const;
  /// A list of three numbers x, y, z.
  [[nodiscard]] Vector3 vector3(const NumberRange& range) const;
  [[nodiscard]] std::vector<YamlNode> list(std::size_t minimum, std::size_t maximum) const;
  /// A map with no other keys than these.
  [[nodiscard]] YamlMap map(const std::vector<std::string>& keys) const;
  /// A map whose keys are not known beforehand, in the order of the file.
  [[nodiscard]] std::vector<std::pair<std::string, YamlNode>> entries() const;

  [[nodiscard]] bool isList() const;
  [[nodiscard]] bool isScalar() const;

  /// Throws "file:line: path: message".
  [[noreturn]] void fail(const std::string& message) const;
  /// Throws "file:line: path: expected <what>, found <this>".
  [[noreturn]] void refuse(const std::string& expected) const;
  /// "file:line: path: ", for warnings and for errors that come from elsewhere.
  [[nodiscard]] std::string place() const;

 private:
  friend class YamlMap;
  struct Element;
  class Builder;
  YamlNode(std::shared_ptr<const std::string> file, std::shared_ptr<const Element> element, std::string path);
  [[nodiscard]] YamlNode child(const std::shared_ptr<const Element>& element, const std::string& path) const;
  [[nodiscard]] std::size_t indexOfWord(const std::vector<std::string>& words) const;
  [[nodiscard]] const std::string& plainScalar(const std::string& expected) const;
  [[nodiscard]] std::string found() const;

  std::shared_ptr<const std::string> file_;
  std::shared_ptr<const Element> element_;
  std::string path_;  // "environment.walls[0]"; empty for the root
};

/// A map of a document, its keys checked. Asking for a key that map() was not told of is a mistake of the caller.
class YamlMap {
 public:
  [[nodiscard]] const YamlNode& node() const { return node_; }
  [[nodiscard]] bool has(const std::string& key) const { return find(key).has_value(); }
  /// Throws when the key is missing.
  [[nodiscard]] YamlNode operator[](const std::string& key) const;
  [[nodiscard]] std::optional<YamlNode> find(const std::string& key) const;

  [[nodiscard]] double numberOr(const std::string& key, const NumberRange& range, double otherwise) const;
  [[nodiscard]] std::int64_t integerOr(const std::string& key, std::int64_t minimum, std::int64_t maximum,
                                       std::int64_t otherwise) const;
  [[nodiscard]] bool booleanOr(const std::string& key, bool otherwise) const;

 private:
  friend class YamlNode;
  YamlMap(YamlNode node, std::vector<std::string> keys) : node_(std::move(node)), keys_(std::move(keys)) {}

  YamlNode node_;
  std::vector<std::string> keys_;
};

/// A number as messages show it.
[[nodiscard]] std::string shownNumber(double x);

/// The text of a file of at most kMaxYamlBytes; throws UsageError when it cannot be read or is larger.
[[nodiscard]] std::string readYamlFile(const std::string& path);

}  // namespace baton
