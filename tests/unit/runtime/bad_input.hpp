/// What the tests of file readers share: where the files of deploy/ are, and how a complaint about a bad file is
/// judged.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>

#include "base/error.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"
#include "support/checkout.hpp"

namespace baton::test {

/// The scenario of that text, for the report's arm; `file` is only a name for messages.
inline Scenario rppScenario(const std::string& file, const std::string& text) {
  static const std::string robot = readYamlFile((deployFolder() / "robots/rpp.yaml").string());
  return parseScenario(file, text, "rpp.yaml", robot);
}

/// The text with its one occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << from << " is there twice";
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// The message that `read` is refused with.
template <typename Read>
std::string refusal(const Read& read) {
  try {
    (void)read();
  } catch (const UsageError& error) {
    return error.what();
  }
  ADD_FAILURE() << "expected a UsageError, found none";
  return "";
}

/// A change that makes a good file bad, and what the message must say about it.
struct BadInput {
  std::string name;
  std::string from, to;
  std::string culprit;   // text of the changed file in the line that the message must name
  std::string expected;  // in the message
  std::string found;     // in the message
};

inline std::ostream& operator<<(std::ostream& stream, const BadInput& bad) { return stream << bad.name; }

/// Checks that `message` is about that line of `file`, whose text is `text`, and says what the input asks it to say.
inline void expectMessage(const std::string& message, const std::string& file, const std::string& text,
                          const BadInput& bad) {
  const std::size_t at = text.find(bad.culprit);
  ASSERT_NE(at, std::string::npos) << bad.culprit;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  EXPECT_EQ(message.rfind(file + ":" + std::to_string(line) + ": ", 0), 0u) << "line " << line << ": " << message;
  EXPECT_NE(message.find(bad.expected), std::string::npos) << message;
  EXPECT_NE(message.find(bad.found), std::string::npos) << message;
}

}  // namespace baton::test
