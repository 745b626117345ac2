#include "schema/idl_preprocessor.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "schema/idl_lexer.hpp"
#include "schema/limits.hpp"

namespace baton::schema {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f\n";

bool isPartOfWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool isComment(std::string_view text) { return text.starts_with("//") || text.starts_with("/*"); }

/// Length of the '\' and the line's end that it takes away; 0 when the line is not continued here.
std::size_t lengthOfContinuation(std::string_view text) {
  return text.starts_with("\\\n") ? 2 : text.starts_with("\\\r\n") ? 3 : 0;
}

/// Length of what is read as one: a word, a comment, a literal, else one character. A literal without its end goes on
/// to the end of its line, a comment to that of the text.
std::size_t lengthOfPart(std::string_view text) {
  if (text.starts_with("//")) return std::min(text.find('\n'), text.size());
  if (text.starts_with("/*")) {
    const std::size_t end = text.find("*/", 2);
    return end == std::string_view::npos ? text.size() : end + 2;
  }
  std::size_t end = 1;
  const char first = text.front();
  if (first == '"' || first == '\'') {
    while (end < text.size() && text[end] != first && text[end] != '\n') end += text[end] == '\\' ? 2 : 1;
    return std::min(end < text.size() && text[end] == first ? end + 1 : end, text.size());
  }
  while (isPartOfWord(first) && end < text.size() && isPartOfWord(text[end])) ++end;
  return end;
}

/// Length of a line for the preprocessor, with those that continue it, up to the end behind it.
std::size_t lengthOfLine(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && text[end] != '\n') {
    const std::string_view rest = text.substr(end);
    end += std::max(lengthOfContinuation(rest), lengthOfPart(rest));
  }
  return end;
}

/// The line as one, without comments.
std::string plainLine(std::string_view line) {
  std::string plain;
  while (!line.empty()) {
    const std::size_t continuation = lengthOfContinuation(line);
    const std::size_t length = continuation > 0 ? continuation : lengthOfPart(line);
    plain += continuation > 0 || isComment(line) ? " " : line.substr(0, length);
    line.remove_prefix(length);
  }
  return plain;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// Takes the word in front, and the blanks around it; empty when there is none.
std::string_view takeWord(std::string_view& text) {
  text = trimmed(text);
  const std::size_t length = text.empty() || !isPartOfWord(text.front()) ? 0 : lengthOfPart(text);
  const std::string_view word = text.substr(0, length);
  text = trimmed(text.substr(length));
  return word;
}

class Preprocessor {
 public:
  explicit Preprocessor(std::string_view text) : text_(text) {}

  std::string run() {
    bool is_begin_of_line = true;
    while (!text_.empty()) {
      const bool is_directive = is_begin_of_line && text_.front() == '#';
      const std::string_view part = text_.substr(0, is_directive ? lengthOfLine(text_) : lengthOfPart(text_));
      const bool is_blank = kBlanks.find(part.front()) != std::string_view::npos || isComment(part);
      is_begin_of_line = part == "\n" || (is_begin_of_line && is_blank);
      if (is_directive ? !obey(part) : isTaken()) {
        is_directive ? append(part) : expand(part);
      } else {
        append(std::string(static_cast<std::size_t>(std::ranges::count(part, '\n')), '\n'));
      }
      line_ += static_cast<std::size_t>(std::ranges::count(part, '\n'));
      text_.remove_prefix(part.size());
    }
    return std::move(out_);
  }

 private:
  enum class Branch { kToCome, kTaken, kPast, kUnknown };  // what of a condition's parts is read

  [[nodiscard]] bool isTaken() const {
    return std::ranges::none_of(branches_, [](Branch one) { return one == Branch::kToCome || one == Branch::kPast; });
  }
  [[nodiscard]] bool isCertain() const { return std::ranges::count(branches_, Branch::kUnknown) == 0; }

  // --- lines for the preprocessor

  /// Whether the line has done what it has to: it is no part of the text then.
  bool obey(std::string_view directive) {
    const std::string line = plainLine(directive.substr(1));
    std::string_view rest = line;
    const std::string_view word = takeWord(rest);
    if (word == "if" || word == "ifdef" || word == "ifndef") return begin(word, rest);
    if (word == "elif" || word == "else") return branches_.empty() ? false : goOn(word, rest);
    if (word == "endif") return end();
    if (!isTaken()) return true;
    if (word == "define") return define(rest);
    if (word == "undef") return undefine(rest);
    return false;
  }

  bool begin(std::string_view word, std::string_view rest) {
    if (branches_.size() == kMaxDepth)
      failAt(line_, "at most " + std::to_string(kMaxDepth) + " #if in each other", "more");
    branches_.push_back(isTaken() ? branchFor(condition(word, rest)) : Branch::kPast);
    return branches_.back() != Branch::kUnknown;
  }

  bool goOn(std::string_view word, std::string_view rest) {
    const Branch before = branches_.back();
    if (before == Branch::kTaken) branches_.back() = Branch::kPast;
    if (before == Branch::kToCome) {
      branches_.back() = word == "else" ? Branch::kTaken : branchFor(condition("if", rest));
    }
    return branches_.back() != Branch::kUnknown;
  }

  bool end() {
    if (branches_.empty()) return false;
    const bool is_known = branches_.back() != Branch::kUnknown;
    branches_.pop_back();
    return is_known || !isTaken();
  }

  static Branch branchFor(std::optional<bool> holds) {
    return !holds ? Branch::kUnknown : *holds ? Branch::kTaken : Branch::kToCome;
  }

  /// Nothing when it cannot be told.
  [[nodiscard]] std::optional<bool> condition(std::string_view word, std::string_view text) const {
    bool is_negated = word == "ifndef";
    while (text.starts_with('!')) {
      is_negated = !is_negated;
      text = trimmed(text.substr(1));
    }
    std::string_view name = takeWord(text);
    std::optional<bool> holds;
    if (word != "if" && text.empty()) {
      holds = isDefined(name);
    } else if (name == "defined") {
      const bool is_within = text.starts_with('(') && text.ends_with(')');
      if (is_within) text = text.substr(1, text.size() - 2);
      name = takeWord(text);
      if (text.empty()) holds = isDefined(name);
    } else if (text.empty()) {
      holds = isNonzero(name);
    }
    return holds ? std::optional(*holds != is_negated) : std::nullopt;
  }

  [[nodiscard]] std::optional<bool> isDefined(std::string_view name) const {
    const auto found = meanings_.find(name);
    if (name.empty() || (found != meanings_.end() && !found->second)) return std::nullopt;
    return found != meanings_.end();
  }

  [[nodiscard]] std::optional<bool> isNonzero(std::string_view text) const {
    if (const auto found = meanings_.find(text); found != meanings_.end() && found->second) text = *found->second;
    const bool is_number = !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
    return is_number ? std::optional(text.find_first_not_of('0') != std::string_view::npos) : std::nullopt;
  }

  bool define(std::string_view rest) {
    const std::string_view all = rest;
    const std::string name(takeWord(rest));
    const bool has_parameters = all.substr(std::min(name.size(), all.size())).starts_with('(');
    if (name.empty() || has_parameters || std::isdigit(static_cast<unsigned char>(name.front())) != 0) return false;
    meanings_[name] = isCertain() ? std::optional<std::string>(rest) : std::nullopt;
    return isCertain();
  }

  bool undefine(std::string_view rest) {
    const std::string name(takeWord(rest));
    if (!isCertain()) return meanings_[name] = std::nullopt, false;
    meanings_.erase(name);
    return true;
  }

  // --- the text

  void append(std::string_view text) {
    out_ += text;
    if (out_.size() > kMaxTextBytes)
      failAt(line_, "at most " + std::to_string(kMaxTextBytes) + " bytes", "more, by #define");
  }

  /// Recursion: as deep as meanings are in meanings.
  void expand(std::string_view part) {
    const auto found = meanings_.find(part);
    const bool is_defined = found != meanings_.end() && found->second;
    if (!is_defined || std::ranges::count(within_, part) > 0) return append(part);
    if (++replaced_ > kMaxDefinitions || within_.size() == kMaxDepth) {
      failAt(line_,
             "at most " + std::to_string(kMaxDefinitions) + " names by #define, " + std::to_string(kMaxDepth) +
                 " within each other",
             "more");
    }
    within_.push_back(found->first);
    std::string_view rest = *found->second;
    while (!rest.empty()) {
      const std::size_t length = lengthOfPart(rest);
      expand(rest.substr(0, length));
      rest.remove_prefix(length);
    }
    within_.pop_back();
  }

  std::string_view text_;
  std::string out_;
  std::size_t line_ = 1;
  std::vector<Branch> branches_;  // of the conditions around, outermost first
  // By name; nothing where it depends on a condition that cannot be told.
  std::map<std::string, std::optional<std::string>, std::less<>> meanings_;
  std::vector<std::string_view> within_;  // names that are being replaced
  std::size_t replaced_ = 0;
};

}  // namespace

std::string preprocessed(std::string_view text) {
  static constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return Preprocessor(text).run();
}

}  // namespace baton::schema
