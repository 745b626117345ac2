#include "dds/parting.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <future>

namespace baton::dds {
namespace {

/// What hangs in its destructor until it is let go.
struct Hanging {
  explicit Hanging(std::shared_future<void> until_in) : until(std::move(until_in)) {}
  ~Hanging() { until.wait(); }
  Hanging(const Hanging&) = delete;
  Hanging& operator=(const Hanging&) = delete;
  std::shared_future<void> until;
};

TEST(Parting, WhatCanBeDestroyedIs) {
  const auto used = std::make_shared<int>(1);
  EXPECT_TRUE(partFrom(std::make_unique<std::shared_ptr<int>>(used)));
  EXPECT_EQ(used.use_count(), 1);
  {
    const Parting<std::shared_ptr<int>> held(used);
    EXPECT_EQ(**held, 1);
    EXPECT_EQ(used.use_count(), 2);
  }
  EXPECT_EQ(used.use_count(), 1);
  EXPECT_EQ(leave(3), 3);
}

// In another process: once something is left over, a process can only be left.
TEST(PartingDeathTest, AProcessEndsWithItsWordsAndItsExitCodeAlthoughSomethingHangs) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto hang = [] {
    static std::promise<void> never;
    static const Hanging at_exit(never.get_future().share());  // as the factory of participants would hang
    dup2(STDERR_FILENO, STDOUT_FILENO);                        // which the test reads
    std::printf("the result");                                 // in a buffer, as when it goes to a file
    if (partFrom(std::make_unique<Hanging>(at_exit.until), std::chrono::milliseconds(1))) return 1;
    return leave(4);
  };
  EXPECT_EXIT(std::exit(hang()), testing::ExitedWithCode(4), "DDS does not let go.*\nthe result");
}

}  // namespace
}  // namespace baton::dds
