#include "runtime/yaml.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>

#include "base/error.hpp"
#include "base/number.hpp"
#include "base/plural.hpp"
#include "base/text.hpp"
#include "control/nearest_name.hpp"
#include "mcap/foreign_format.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kMaxShown = 60;  // bytes of a file's text in a message

/// Text from outside, fit for a terminal: short and on one line.
std::string tidied(const std::string& text) {
  return escaped(text.substr(0, kMaxShown)) + (text.size() > kMaxShown ? "..." : "");
}

std::string quoted(const std::string& text) { return "'" + tidied(text) + "'"; }

/// A decimal number, or [sign][a*]pi[/b], which is (a pi)/b.
std::optional<double> parseNumber(const std::string& scalar) {
  std::string text = scalar;
  std::erase(text, ' ');
  const bool has_blanks = text.size() != scalar.size();
  const std::size_t pi = text.find("pi");
  const bool has_sign = !text.empty() && (text[0] == '+' || text[0] == '-');
  const double sign = has_sign && text[0] == '-' ? -1.0 : 1.0;
  const std::string_view unsigned_text = std::string_view(text).substr(has_sign ? 1 : 0);
  if (pi == std::string::npos) return has_blanks ? std::nullopt : numberIn<double>(text);
  const auto parseDecimal = [](std::string_view one) {
    return one.starts_with('+') || one.starts_with('-') ? std::nullopt : numberIn<double>(one);
  };

  const std::string_view before = unsigned_text.substr(0, pi - (has_sign ? 1 : 0));
  const std::string_view after = std::string_view(text).substr(pi + 2);
  if (!before.empty() && before.back() != '*') return std::nullopt;
  if (!after.empty() && after.front() != '/') return std::nullopt;
  const auto a = before.empty() ? 1.0 : parseDecimal(before.substr(0, before.size() - 1));
  const auto b = after.empty() ? 1.0 : parseDecimal(after.substr(1));
  if (!a || !b) return std::nullopt;
  const double value = sign * *a * kPi / *b;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

[[noreturn]] void failAt(const std::string& file, int line, const std::string& message) {
  throw UsageError(file + ":" + std::to_string(line) + ": " + message);
}

/// Files that are given in the place of a scenario or a robot; empty for what may be YAML.
std::string otherFormat(std::string_view text) {
  if (text.starts_with("\x89MCAP")) return "a recording; `baton rerun` does a recorded run again";
  if (const mcap::ForeignFormat* format = mcap::foreignFormat(text)) {
    return std::string("a file that is ") + format->what +
           (format->is_packed ? std::string(": ") + format->remedy : "; give a file that ends in .yaml");
  }
  const auto is_zero = [&](std::size_t i) { return text[i] == '\0'; };
  const bool is_wide =
      text.size() > 3 && is_zero(0) != is_zero(1) && is_zero(0) == is_zero(2) && is_zero(1) == is_zero(3);
  if (is_wide || text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    return "text in UTF-16; save it as UTF-8";
  }
  const std::size_t begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (begin != std::string_view::npos && text[begin] == '<') {
    return "XML, as a robot description (URDF) is; a robot's file lists joints and masses as deploy/robots/rpp.yaml "
           "does";
  }
  return "";
}

int lineOf(const YAML::Mark& mark) { return mark.is_null() ? 1 : mark.line + 1; }

}  // namespace

std::string NumberRange::text() const {
  const std::string in_unit = unit.empty() ? "" : " " + unit;
  const bool has_minimum = std::isfinite(minimum), has_maximum = std::isfinite(maximum);
  if (!has_minimum && !has_maximum) return unit.empty() ? "a number" : "a number [" + unit + "]";
  const std::string lower = (open ? "above " : "from ") + shownNumber(minimum);
  if (!has_maximum)
    return open ? "a number " + lower + in_unit : "a number of at least " + shownNumber(minimum) + in_unit;
  if (!has_minimum) return "a number of at most " + shownNumber(maximum) + in_unit;
  return "a number " + lower + (open ? " and up to " : " to ") + shownNumber(maximum) + in_unit;
}

/// One value of the document, with all that is below it.
struct YamlNode::Element {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  int line = 1;
  std::string scalar;
  bool is_plain = true;                                  // written without quotes
  std::vector<std::string> keys;                         // of a map, in the order of the file
  std::vector<int> key_lines;                            // one per key
  std::vector<std::shared_ptr<const Element>> children;  // of a list or a map
};

/// Builds the tree from the parser's events, so that depth, anchors and duplicate keys are refused where they stand and
/// before they cost anything.
class YamlNode::Builder final : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& file) : file_(file) {}
  [[nodiscard]] std::shared_ptr<const Element> root() const { return root_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (root_) failAt(file_, lineOf(mark), "expected one document, found a second one");
  }
  void OnDocumentEnd() override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    failAt(file_, lineOf(mark),
           "expected a value, found an alias (*name), which is not supported; write the value out");
  }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (isKeyNext()) failAt(file_, lineOf(mark), "expected a key, found nothing before the ':'");
    keep(element(Element::Kind::kNull, mark, anchor, ""));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    if (isKeyNext()) return addKey(mark, anchor, value);
    auto scalar = element(Element::Kind::kScalar, mark, anchor, tag);
    scalar->scalar = value;
    scalar->is_plain = tag == "?";
    keep(scalar);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(Element::Kind::kList, mark, anchor, tag);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(Element::Kind::kMap, mark, anchor, tag);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  [[nodiscard]] bool isKeyNext() const {
    return !open_.empty() && open_.back()->kind == Element::Kind::kMap &&
           open_.back()->keys.size() == open_.back()->children.size();
  }

  std::shared_ptr<Element> element(Element::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor,
                                   const std::string& tag) const {
    refuseAnchor(mark, anchor);
    if (!tag.empty() && tag != "?" && tag != "!") {
      failAt(file_, lineOf(mark), "expected a plain value, found a tag, which is not supported: " + quoted(tag));
    }
    auto made = std::make_shared<Element>();
    made->kind = kind;
    made->line = lineOf(mark);
    // The parser marks a block by its first entry and nothing by what follows. People look for it at its key, and for
    // the whole document at its beginning.
    const bool is_below_key = !open_.empty() && open_.back()->kind == Element::Kind::kMap;
    if (kind != Element::Kind::kScalar && is_below_key) made->line = open_.back()->key_lines.back();
    if (kind != Element::Kind::kScalar && open_.empty()) made->line = 1;
    return made;
  }

  void refuseAnchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
    if (anchor != 0) failAt(file_, lineOf(mark), "expected a value, found an anchor (&name), which is not supported");
  }

  void addKey(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& key) {
    refuseAnchor(mark, anchor);
    Element& map = *open_.back();
    // Long maps would make this search slow; no file of ours has a long one.
    constexpr std::size_t kMaxKeys = 256;
    if (map.keys.size() == kMaxKeys) {
      failAt(file_, lineOf(mark), "expected at most " + counted(kMaxKeys, "key") + " in a map, found more");
    }
    const auto twin = std::find(map.keys.begin(), map.keys.end(), key);
    if (twin != map.keys.end()) {
      const int first = map.key_lines[static_cast<std::size_t>(twin - map.keys.begin())];
      failAt(file_, lineOf(mark),
             "expected each key once, found a second " + quoted(key) + " (the first is on line " +
                 std::to_string(first) + ")");
    }
    map.keys.push_back(key);
    map.key_lines.push_back(lineOf(mark));
  }

  void begin(Element::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag) {
    if (isKeyNext()) failAt(file_, lineOf(mark), "expected a word as the key, found a list or a map");
    if (open_.size() == static_cast<std::size_t>(kMaxYamlDepth)) {
      failAt(file_, lineOf(mark),
             "expected at most " + std::to_string(kMaxYamlDepth) + " lists and maps within each other, found more");
    }
    const auto made = element(kind, mark, anchor, tag);
    keep(made);
    open_.push_back(made);
  }

  void keep(const std::shared_ptr<Element>& made) {
    if (open_.empty()) {
      root_ = made;
    } else {
      open_.back()->children.push_back(made);
    }
  }

  const std::string& file_;
  std::shared_ptr<Element> root_;
  std::vector<std::shared_ptr<Element>> open_;  // from the root to where the parser is
};

YamlNode::YamlNode(std::shared_ptr<const std::string> file, std::shared_ptr<const Element> element, std::string path)
    : file_(std::move(file)), element_(std::move(element)), path_(std::move(path)) {}

YamlNode YamlNode::parse(const std::string& file, const std::string& text) {
  if (text.size() > kMaxYamlBytes) {
    failAt(file, 1, "expected at most " + counted(kMaxYamlBytes, "byte") + ", found " + std::to_string(text.size()));
  }
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
    failAt(file, static_cast<int>(line), "expected text, found a zero byte");
  }
  Builder builder(file);
  try {
    // Without what is blank at its end: yaml-cpp 0.7 takes an open quote for closed when the text ends in a line break.
    std::istringstream stream(text.substr(0, text.find_last_not_of(" \t\r\n") + 1));
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    failAt(file, lineOf(error.mark), "expected valid YAML, found: " + error.msg);
  }
  auto root = builder.root() ? builder.root() : std::make_shared<const Element>();
  return {std::make_shared<const std::string>(file), std::move(root), ""};
}

YamlNode YamlNode::child(const std::shared_ptr<const Element>& element, const std::string& path) const {
  return {file_, element, path};
}

std::string YamlNode::place() const {
  return *file_ + ":" + std::to_string(element_->line) + ": " + (path_.empty() ? "" : path_ + ": ");
}

void YamlNode::fail(const std::string& message) const { throw UsageError(place() + message); }

void YamlNode::refuse(const std::string& expected) const { fail("expected " + expected + ", found " + found()); }

std::string YamlNode::found() const {
  switch (element_->kind) {
    case Element::Kind::kNull: return "nothing";
    case Element::Kind::kScalar: return quoted(element_->scalar) + commaHint(element_->scalar);
    case Element::Kind::kList: return "a list of " + counted(element_->children.size(), "value");
    case Element::Kind::kMap: return "a map with " + counted(element_->keys.size(), "key");
  }
  return "";
}

bool YamlNode::isList() const { return element_->kind == Element::Kind::kList; }

bool YamlNode::isScalar() const { return element_->kind == Element::Kind::kScalar; }

const std::string& YamlNode::plainScalar(const std::string& expected) const {
  if (!isScalar()) refuse(expected);
  if (!element_->is_plain) fail("expected " + expected + ", found the text " + quoted(element_->scalar) + " in quotes");
  return element_->scalar;
}

double YamlNode::number(const NumberRange& range) const {
  const auto value = parseNumber(plainScalar(range.text()));
  const bool is_low_enough = value && *value <= range.maximum;
  if (!is_low_enough || *value < range.minimum || (range.open && *value == range.minimum)) refuse(range.text());
  return *value;
}

std::int64_t YamlNode::integer(std::int64_t minimum, std::int64_t maximum) const {
  const std::string expected = "a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum);
  const std::string& text = plainScalar(expected);
  const auto value = numberIn<std::int64_t>(text);
  if (!value || *value < minimum || *value > maximum) refuse(expected);
  return *value;
}

bool YamlNode::boolean() const {
  const std::string& word = plainScalar("true or false");
  if (word != "true" && word != "false") refuse("true or false");
  return word == "true";
}

std::string YamlNode::text(std::size_t max_length) const {
  if (!isScalar()) refuse("text");
  if (element_->scalar.size() > max_length) refuse("text of at most " + counted(max_length, "byte"));
  return element_->scalar;
}

bool isName(const std::string& text) {
  const auto is_fit = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !text.empty() && text.size() <= 31 && text[0] != '-' && std::all_of(text.begin(), text.end(), is_fit);
}

std::string YamlNode::name() const {
  if (!isScalar() || !isName(element_->scalar)) refuse(kNameRule);
  return element_->scalar;
}

std::size_t YamlNode::indexOfWord(const std::vector<std::string>& words) const {
  std::string expected;
  for (const std::string& word : words) expected += (expected.empty() ? "one of " : ", ") + word;
  const auto word = std::find(words.begin(), words.end(), plainScalar(expected));
  if (word == words.end()) refuse(expected);
  return static_cast<std::size_t>(word - words.begin());
}

std::vector<double> YamlNode::numbers(std::size_t size, const NumberRange& range, const std::string& each) const {
  const std::string expected = "a list of " + counted(size, "number") + (each.empty() ? "" : ", one per " + each);
  const bool is_twice = isList() && element_->children.size() == 2 * size;  // as [0,5, 0,1] is
  if (is_twice) refuse(expected + " whose decimal sign is a point");
  if (!isList() || element_->children.size() != size) refuse(expected);
  std::vector<double> values;
  for (const YamlNode& item : list(size, size)) values.push_back(item.number(range));
  return values;
}

Vector3 YamlNode::vector3(const NumberRange& range) const { return Vector3(numbers(3, range, "axis x, y, z").data()); }

std::vector<YamlNode> YamlNode::list(std::size_t minimum, std::size_t maximum) const {
  const std::size_t size = element_->children.size();
  if (!isList() || size < minimum || size > maximum) {
    refuse("a list of " + std::to_string(minimum) + " to " + std::to_string(maximum) + " values" +
           (minimum == 0 ? " ([] for none)" : ""));
  }
  std::vector<YamlNode> items;
  for (const auto& element : element_->children) {
    items.push_back(child(element, path_ + "[" + std::to_string(items.size()) + "]"));
  }
  return items;
}

std::vector<std::pair<std::string, YamlNode>> YamlNode::entries() const {
  if (element_->kind != Element::Kind::kMap) refuse("a map");
  std::vector<std::pair<std::string, YamlNode>> all;
  for (std::size_t i = 0; i < element_->keys.size(); ++i) {
    const std::string& key = element_->keys[i];
    all.emplace_back(key, child(element_->children[i], path_.empty() ? key : path_ + "." + key));
  }
  return all;
}

YamlMap YamlNode::map(const std::vector<std::string>& keys) const {
  if (element_->kind != Element::Kind::kMap) {
    std::string expected;
    for (const std::string& key : keys) expected += (expected.empty() ? "" : ", ") + key;
    refuse("a map with keys out of " + expected);
  }
  for (std::size_t i = 0; i < element_->keys.size(); ++i) {
    const std::string& key = element_->keys[i];
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const std::string where = path_.empty() ? "" : path_ + ": ";
    failAt(*file_, element_->key_lines[i], where + unknownName("key", tidied(key), keys));
  }
  return {*this, keys};
}

std::optional<YamlNode> YamlMap::find(const std::string& key) const {
  assert(std::find(keys_.begin(), keys_.end(), key) != keys_.end());
  const YamlNode::Element& map = *node_.element_;
  const auto entry = std::find(map.keys.begin(), map.keys.end(), key);
  if (entry == map.keys.end()) return std::nullopt;
  const auto index = static_cast<std::size_t>(entry - map.keys.begin());
  return node_.child(map.children[index], node_.path_.empty() ? key : node_.path_ + "." + key);
}

YamlNode YamlMap::operator[](const std::string& key) const {
  if (auto value = find(key)) return *std::move(value);
  std::string given;
  for (const std::string& one : node_.element_->keys) given += (given.empty() ? "only " : ", ") + tidied(one);
  node_.fail("expected the key '" + key + "', found " + (given.empty() ? "none" : given));
}

double YamlMap::numberOr(const std::string& key, const NumberRange& range, double otherwise) const {
  const auto value = find(key);
  return value ? value->number(range) : otherwise;
}

std::int64_t YamlMap::integerOr(const std::string& key, std::int64_t minimum, std::int64_t maximum,
                                std::int64_t otherwise) const {
  const auto value = find(key);
  return value ? value->integer(minimum, maximum) : otherwise;
}

bool YamlMap::booleanOr(const std::string& key, bool otherwise) const {
  const auto value = find(key);
  return value ? value->boolean() : otherwise;
}

std::string shownNumber(double x) {
  std::ostringstream text;
  text.precision(12);
  text << x;
  return text.str();
}

std::string readYamlFile(const std::string& path) {
  // Of a pipe the first byte may never come.
  std::error_code none;
  if (std::filesystem::exists(path, none) && !std::filesystem::is_regular_file(path, none)) {
    throw UsageError(path + ": expected a file, found " + whyNoFile(path));
  }
  int error = 0;
  std::string text = readFile(path, kMaxYamlBytes + 1, error);
  if (error != 0) throw UsageError(path + ": expected a file that can be read, found: " + std::strerror(error));
  if (const std::string other = otherFormat(text); !other.empty()) {
    throw UsageError(path + ": expected YAML, found " + other);
  }
  if (text.size() > kMaxYamlBytes) {
    throw UsageError(path + ": expected a file of at most " + counted(kMaxYamlBytes, "byte") + ", found a larger one");
  }
  return text;
}

}  // namespace baton
