#include "dds/parting.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <future>
#include <iostream>

namespace baton::dds {
namespace {

/// What hangs in its destructor until it is let go.
struct Hanging {
  std::shared_future<void> until;
  ~Hanging() { until.wait(); }
};

TEST(Parting, WhatCanBeDestroyedIs) {
  const auto used = std::make_shared<int>(1);
  EXPECT_TRUE(partFrom(std::make_unique<std::shared_ptr<int>>(used)));
  EXPECT_EQ(used.use_count(), 1);
  EXPECT_EQ(leave(3), 3);
}

// In a process of its own: once something is left over, a process can only be left.
TEST(PartingDeathTest, AProcessEndsWithItsWordsAndItsExitCodeAlthoughSomethingHangs) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto hang = [] {
    static std::promise<void> never;
    static Hanging at_exit{never.get_future().share()};  // as the factory of participants would hang
    std::cout << "the result\n";
    if (partFrom(std::make_unique<Hanging>(at_exit.until), std::chrono::milliseconds(1))) return 1;
    std::fputs("the reason\n", stderr);
    return leave(4);
  };
  EXPECT_EXIT(std::exit(hang()), testing::ExitedWithCode(4), "the reason");
}

}  // namespace
}  // namespace baton::dds
