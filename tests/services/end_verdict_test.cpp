#include "end_verdict.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

constexpr Child::End exited(int code) { return {.by_signal = false, .value = code}; }
constexpr Child::End signalled(int number) { return {.by_signal = true, .value = number}; }

TEST(EndVerdict, APartEndsInOrderByItselfOrByWhatItIsSentAtTheEnd) {
  EXPECT_EQ(endVerdict(exited(0), false, false, false), EndVerdict::kInOrder);
  EXPECT_EQ(endVerdict(signalled(SIGTERM), false, true, false), EndVerdict::kInOrder);
  EXPECT_EQ(endVerdict(signalled(SIGKILL), false, true, true), EndVerdict::kInOrder);
}

TEST(EndVerdict, WhateverElseEndsItIsADeath) {
  for (const int number : {SIGSEGV, SIGABRT, SIGBUS}) {
    EXPECT_EQ(endVerdict(signalled(number), false, true, true), EndVerdict::kDied) << number;
  }
  EXPECT_EQ(endVerdict(exited(1), false, true, false), EndVerdict::kDied);
  EXPECT_EQ(endVerdict(signalled(SIGKILL), false, true, false), EndVerdict::kDied);   // not by us
  EXPECT_EQ(endVerdict(signalled(SIGTERM), false, false, false), EndVerdict::kDied);  // likewise
}

TEST(EndVerdict, ARecorderThatIsMadeToEndLeavesAnIncompleteRecording) {
  EXPECT_EQ(endVerdict(exited(0), true, true, false), EndVerdict::kInOrder);
  EXPECT_EQ(endVerdict(exited(1), true, true, false), EndVerdict::kIncomplete);
  EXPECT_EQ(endVerdict(signalled(SIGTERM), true, true, false), EndVerdict::kIncomplete);
  EXPECT_EQ(endVerdict(signalled(SIGKILL), true, true, true), EndVerdict::kIncomplete);
}

}  // namespace
}  // namespace baton
