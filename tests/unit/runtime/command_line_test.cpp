#include "runtime/command_line.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "mcap/error.hpp"

namespace baton {
namespace {

/// What a command line with one number of each kind makes of these words.
struct Numbers {
  std::uint64_t whole = 7;
  std::optional<std::uint64_t> maybe;
  double real = 7.0;
  std::optional<double> maybe_real;

  /// Whether they are taken.
  bool parse(std::vector<const char*> words) {
    CLI::App app("test");
    CLI::App* command = app.add_subcommand("do", "");
    command->add_option("--whole", whole, "");
    command->add_option("--maybe", maybe, "");
    command->add_option_function<std::uint64_t>(
        "--called", [this](const std::uint64_t& n) { whole = n; }, "");
    command->add_option("--real", real, "");
    command->add_option("--maybe-real", maybe_real, "");
    words.insert(words.begin(), {"baton", "do"});
    try {
      runCommand(app, static_cast<int>(words.size()), words.data());
    } catch (const UsageError&) {
      return false;
    }
    return true;
  }
};

TEST(CommandLine, TakesNumbers) {
  Numbers numbers;
  EXPECT_TRUE(numbers.parse({"--whole", "18446744073709551615", "--real", "-1.5e3", "--maybe", "0"}));
  EXPECT_EQ(numbers.whole, UINT64_MAX);
  EXPECT_EQ(numbers.maybe, 0U);
  EXPECT_EQ(numbers.real, -1500.0);
  EXPECT_TRUE(numbers.parse({"--whole", "+3", "--real", "+0.5", "--maybe", "+1"}));
  EXPECT_EQ(numbers.whole, 3U);
  EXPECT_EQ(numbers.maybe, 1U);
  EXPECT_EQ(numbers.real, 0.5);
}

TEST(CommandLine, RefusesWhatIsNoWholeNumber) {
  for (const char* option : {"--whole", "--maybe", "--called"}) {
    for (const char* word : {"-1", "18446744073709551616", "1.5", "1,5", "++1", "1e3", "nan", "", " 1", "0x10", "1x"}) {
      Numbers numbers;
      EXPECT_FALSE(numbers.parse({option, word})) << option << " '" << word << "'";
      EXPECT_EQ(numbers.whole, 7U) << option << " '" << word << "'";
    }
  }
}

TEST(CommandLine, RefusesWhatIsNoFiniteNumber) {
  for (const char* option : {"--real", "--maybe-real"}) {
    for (const char* word : {"nan", "-nan", "inf", "-inf", "1e999", "", "1x", "0,5", "+-1"}) {
      Numbers numbers;
      EXPECT_FALSE(numbers.parse({option, word})) << option << " '" << word << "'";
      EXPECT_EQ(numbers.real, 7.0);
    }
  }
}

/// What is said of a line of a program with the commands status, swap and bag, which has info and export --out FILE.
std::string refusalOf(std::vector<const char*> words) {
  CLI::App app("test");
  app.name("baton");
  app.require_subcommand(1);
  double blend = 0.0;
  int domain = 0;
  std::string out;
  app.add_subcommand("status", "")->add_option("--domain", domain, "")->check(wholeBetween(0, 232));
  app.add_subcommand("swap", "")->add_option("--blend", blend, "")->check(between(0.0, 10'000.0));
  CLI::App* bag = app.add_subcommand("bag", "");
  bag->require_subcommand(1);
  bag->add_subcommand("info", "");
  bag->add_subcommand("export", "")->add_option("--out", out, "")->required();
  words.insert(words.begin(), "baton");
  try {
    runCommand(app, static_cast<int>(words.size()), words.data());
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(CommandLine, AWordThatIsNoCommandIsNamedWithTheNearestThatIs) {
  EXPECT_EQ(refusalOf({"stat"}), "unknown command 'stat'; did you mean 'status'? Known: status, swap, bag");
  EXPECT_EQ(refusalOf({"bag", "inf", "x"}), "unknown command of bag 'inf'; did you mean 'info'? Known: info, export");
  EXPECT_EQ(refusalOf({"status"}), "");
}

TEST(CommandLine, ARefusalNamesTheCommandAndItsHelp) {
  EXPECT_EQ(refusalOf({}), "A subcommand is required; see `baton --help`");
  EXPECT_EQ(refusalOf({"bag"}), "bag: A subcommand is required; see `baton bag --help`");
  EXPECT_EQ(refusalOf({"bag", "export"}), "bag export: --out is required; see `baton bag export --help`");
}

TEST(CommandLine, ANumberOutOfRangeIsToldTheRange) {
  for (const char* word : {"-1", "233", "1.5", "nan", "", "0x1"}) {
    EXPECT_EQ(refusalOf({"status", "--domain", word}),
              "status: --domain: expected a whole number from 0 to 232, found '" + std::string(word) +
                  "'; see `baton status --help`");
  }
  EXPECT_EQ(refusalOf({"status", "--domain", "232"}), "");
  for (const char* word : {"-0.1", "10001", "inf"}) {
    EXPECT_NE(refusalOf({"swap", "--blend", word}).find("--blend: expected a "), std::string::npos) << word;
  }
  EXPECT_EQ(refusalOf({"swap", "--blend", "1e4"}), "");
}

TEST(CommandLine, ANumberWithACommaIsToldOfThePoint) {
  EXPECT_NE(refusalOf({"swap", "--blend", "0,5"}).find("found '0,5'; the decimal sign is a point: 0.5; see"),
            std::string::npos);
}

TEST(CommandLine, ARateIsOneThatCanBeSeen) {
  EXPECT_EQ(parseRate("rate", "max", 1000.0), 0.0);
  EXPECT_EQ(parseRate("rate", "+2", 1000.0), 2.0);
  EXPECT_EQ(parseRate("rate", "0.5", 1000.0), 0.5);
  EXPECT_EQ(parseRate("rate", "1000", 1000.0), 1000.0);
  for (const char* word : {"0", "-1", "nan", "inf", "1e-300", "1e300", "1001", "", "1x"}) {
    EXPECT_THROW((void)parseRate("rate", word, 1000.0), UsageError) << word;
  }
}

TEST(CommandLine, WhatStumblesOverADamagedRecordingNamesTheRemedy) {
  const auto refusal = [](auto error) {
    CLI::App app("test");
    app.name("baton");
    app.add_subcommand("hash", "")->callback([&] { throw error; });
    const char* words[] = {"baton", "hash"};
    try {
      runCommand(app, 2, words);
    } catch (const UsageError& refused) {
      return std::string(refused.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(mcap::FormatError("its CRC is wrong")),
            "its CRC is wrong; `baton bag recover` makes a recording of all that can be read");
  EXPECT_EQ(refusal(mcap::NotARecording("it is text")), "it is text");
  EXPECT_EQ(refusal(UsageError("no such step")), "no such step");
}

TEST(CommandLine, AnOptionThatIsGivenTwiceIsToldInOurWords) {
  EXPECT_EQ(refusalOf({"swap", "--blend", "1", "--blend", "2"}),
            "swap: --blend: expected once, found 2 times; see `baton swap --help`");
}

TEST(CommandLine, AWrongDomainOfTheEnvironmentIsNotBlamedOnAnOption) {
  const auto refusal = [](std::vector<const char*> words) {
    CLI::App app("test");
    int domain = 0;
    addDomain(app, domain)->envname("BATON_TEST_DOMAIN");
    words.insert(words.begin(), "baton");
    try {
      (void)parseCommandLine(app, static_cast<int>(words.size()), words.data());
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ASSERT_EQ(::setenv("BATON_TEST_DOMAIN", "abc", 1), 0);
  EXPECT_EQ(refusal({}).find("BATON_DOMAIN in the environment: expected a whole number from 0 to 232, found 'abc'"), 0U)
      << refusal({});
  EXPECT_EQ(refusal({"--domain", "x"}).find("--domain: expected a whole number"), 0U) << refusal({"--domain", "x"});
  ASSERT_EQ(::unsetenv("BATON_TEST_DOMAIN"), 0);
}

}  // namespace
}  // namespace baton
