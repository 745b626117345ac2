/// What programs print changes no terminal, whatever others are called.
#include "runtime/say.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "base/error.hpp"
#include "runtime/json.hpp"
#include "runtime/log.hpp"
#include "runtime/run.hpp"

namespace baton {
namespace {

const std::string kHostile =
    "a\xc2\x9b"
    "2J\x1b[2J\x9b\x07";
const std::string kShown = "a\\u009b2J\\x1b[2J\\x9b\\x07";

TEST(Say, ShowsWhatATerminalWouldObey) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  say("%s: %d\n", kHostile.c_str(), 3);
  sayf("{}: {:>3}\n", kHostile, 4);
  sayText(kHostile + "\n");
  say(stderr, "%s\n", kHostile.c_str());
  EXPECT_EQ(testing::internal::GetCapturedStdout(), kShown + ": 3\n" + kShown + ":   4\n" + kShown + "\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), kShown + "\n");
}

TEST(Say, NobodysNameBeginsALine) {
  const std::string name = "a\nrecording: complete", shown = "a\\nrecording: complete";
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  sayf("{:<{}}|{}|{}|{}\n", name, 25, std::string_view(name), name.c_str(), "b\nc");
  sayWarning(name);
  EXPECT_EQ(runGuarded("baton",
                       [&]() -> ExitCode {
                         throw UnavailableError("topic " + name + " is not there; the end of the log:",
                                                "  one\n  two\n");
                       }),
            3);
  EXPECT_EQ(runGuarded("baton", [&]() -> ExitCode { throw std::logic_error(name); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), shown + "   |" + shown + "|" + shown + "|b\\nc\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "baton: warning: " + shown + "\nbaton: topic " + shown +
                                                        " is not there; the end of the log:\n  one\n  two\n" +
                                                        "baton: unexpected: " + shown + "\n");
}

TEST(Say, WhatDoesNotArriveIsAFailure) {
  const auto saying = [](const char* device, ExitCode code, std::size_t bytes) {
    return [=] {
      if (std::freopen(device, "w", stdout) == nullptr) std::exit(99);
      std::exit(runGuarded("baton", [&] {
        for (std::size_t i = 0; i < bytes; ++i) sayText("x");
        return code;
      }));
    };
  };
  const char* const kWhy = "^baton: standard output cannot be written: No space left on device\n$";
  for (const std::size_t bytes : {1, 100'000}) {
    EXPECT_EXIT(saying("/dev/full", ExitCode::kOk, bytes)(), testing::ExitedWithCode(3), kWhy) << bytes;
    EXPECT_EXIT(saying("/dev/full", ExitCode::kUsage, bytes)(), testing::ExitedWithCode(2), kWhy) << bytes;
    EXPECT_EXIT(saying("/dev/null", ExitCode::kOk, bytes)(), testing::ExitedWithCode(0), "^$") << bytes;
  }
  EXPECT_EXIT(saying("/dev/full", ExitCode::kOk, 0)(), testing::ExitedWithCode(0), "^$") << "nothing was said";
}

TEST(Say, WhoeverReadsMayHaveEnough) {
  const auto saying = [](bool by_cout) {
    int pipe_ends[2];
    if (pipe(pipe_ends) != 0) std::exit(99);
    close(pipe_ends[0]);
    dup2(pipe_ends[1], STDOUT_FILENO);
    std::exit(runGuarded("baton", [&] {
      const std::string text(100'000, 'x');
      by_cout ? void(std::cout << text) : sayText(text);
      return ExitCode::kOk;
    }));
  };
  EXPECT_EXIT(saying(false), testing::ExitedWithCode(0), "^$");
  EXPECT_EXIT(saying(true), testing::ExitedWithCode(0), "^$") << "as the text of --help goes";
}

TEST(Say, ALogDoesTheSame) {
  const auto before = spdlog::default_logger();
  testing::internal::CaptureStderr();
  setUpLog("test");
  spdlog::warn("{}", kHostile);
  spdlog::warn("{}", "topic a\n03:15:12.345678 error plant: forged");
  spdlog::default_logger()->flush();
  const std::string log = testing::internal::GetCapturedStderr();
  spdlog::set_default_logger(before);
  EXPECT_NE(log.find(" warning test: " + kShown + "\n"), std::string::npos) << log;
  EXPECT_NE(log.find(" warning test: topic a\\n03:15:12.345678 error plant: forged\n"), std::string::npos) << log;
}

TEST(Say, JsonIsPrintedAsItIs) {
  const nlohmann::ordered_json json{{"name", kHostile + "\x7f \u00fc"}};
  const std::string text = toText(json);
  EXPECT_EQ(text.find_first_of("\x7f\x1b\x07\x9b"), std::string::npos) << text;
  testing::internal::CaptureStdout();
  sayText(text);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), text);
  EXPECT_EQ(nlohmann::json::parse(text).at("name"),
            "a\xc2\x9b"
            "2J\x1b[2J\xef\xbf\xbd\x07\x7f \u00fc");
}

}  // namespace
}  // namespace baton
