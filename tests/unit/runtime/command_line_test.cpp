#include "runtime/command_line.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

namespace baton {
namespace {

/// What a command line with one number of each kind makes of these words.
struct Numbers {
  std::uint64_t whole = 7;
  std::optional<std::uint64_t> maybe;
  double real = 7.0;
  std::optional<double> maybe_real;

  ExitCode parse(std::vector<const char*> words) {
    CLI::App app("test");
    CLI::App* command = app.add_subcommand("do", "");
    command->add_option("--whole", whole, "");
    command->add_option("--maybe", maybe, "");
    command->add_option_function<std::uint64_t>(
        "--called", [this](const std::uint64_t& n) { whole = n; }, "");
    command->add_option("--real", real, "");
    command->add_option("--maybe-real", maybe_real, "");
    words.insert(words.begin(), {"baton", "do"});
    return runCommand(app, static_cast<int>(words.size()), words.data());
  }
};

TEST(CommandLine, TakesNumbers) {
  Numbers numbers;
  EXPECT_EQ(numbers.parse({"--whole", "18446744073709551615", "--real", "-1.5e3", "--maybe", "0"}), ExitCode::kOk);
  EXPECT_EQ(numbers.whole, UINT64_MAX);
  EXPECT_EQ(numbers.maybe, 0U);
  EXPECT_EQ(numbers.real, -1500.0);
}

TEST(CommandLine, RefusesWhatIsNoWholeNumber) {
  for (const char* option : {"--whole", "--maybe", "--called"}) {
    for (const char* word : {"-1", "18446744073709551616", "1.5", "1e3", "nan", "", " 1", "0x10", "1x"}) {
      Numbers numbers;
      EXPECT_EQ(numbers.parse({option, word}), ExitCode::kUsage) << option << " '" << word << "'";
      EXPECT_EQ(numbers.whole, 7U) << option << " '" << word << "'";
    }
  }
}

TEST(CommandLine, RefusesWhatIsNoFiniteNumber) {
  for (const char* option : {"--real", "--maybe-real"}) {
    for (const char* word : {"nan", "-nan", "inf", "-inf", "1e999", "", "1x"}) {
      Numbers numbers;
      EXPECT_EQ(numbers.parse({option, word}), ExitCode::kUsage) << option << " '" << word << "'";
      EXPECT_EQ(numbers.real, 7.0);
    }
  }
}

TEST(CommandLine, ARateIsOneThatCanBeSeen) {
  EXPECT_EQ(parseRate("rate", "max"), 0.0);
  EXPECT_EQ(parseRate("rate", "0.5"), 0.5);
  for (const char* word : {"0", "-1", "nan", "inf", "1e-300", "", "1x"}) {
    EXPECT_THROW((void)parseRate("rate", word), UsageError) << word;
  }
}

}  // namespace
}  // namespace baton
