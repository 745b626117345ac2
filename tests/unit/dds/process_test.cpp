#include "dds/process.hpp"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <ctime>

namespace baton::dds {
namespace {

/// A child that waits for its end.
pid_t forkOne() {
  const pid_t child = fork();
  if (child != 0) return child;
  pause();
  _exit(0);
}

TEST(Process, SaysWhoseChildItIsAndWhenItBegan) {
  const auto own = factsOf(getpid());
  ASSERT_TRUE(own.has_value());
  EXPECT_EQ(own->parent, getppid());
  const pid_t child = forkOne();
  const auto its = factsOf(child);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  ASSERT_TRUE(its.has_value());
  EXPECT_EQ(its->parent, getpid());
  EXPECT_GE(its->began, own->began);
  EXPECT_GT(own->began, 0u);
  EXPECT_FALSE(factsOf(child).has_value());
  EXPECT_EQ(processBegan(child), 0u);
}

TEST(Process, CountsWhatItHasComputed) {
  const auto own_ticks = [] {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    const double seconds = static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
    return seconds * static_cast<double>(sysconf(_SC_CLK_TCK));
  };
  while (own_ticks() < 5.0) {
  }
  const double before = own_ticks();
  const auto facts = factsOf(getpid());
  const double after = own_ticks();
  ASSERT_TRUE(facts.has_value());
  EXPECT_GE(static_cast<double>(facts->cpu_ticks), before - 2.0);  // its own and the kernel's part, each rounded down
  EXPECT_LE(static_cast<double>(facts->cpu_ticks), after + 1.0);
}

TEST(Process, IsReadWhateverItsName) {
  char name[16] = {};
  prctl(PR_GET_NAME, name);
  const auto before = factsOf(getpid());
  for (const char* odd : {"a b", "a) R 1 1 (b", ")", "", "\n"}) {
    prctl(PR_SET_NAME, odd);
    const auto facts = factsOf(getpid());
    ASSERT_TRUE(facts.has_value()) << odd;
    EXPECT_EQ(facts->parent, getppid()) << odd;
    EXPECT_EQ(facts->began, before->began) << odd;
  }
  prctl(PR_SET_NAME, name);
}

TEST(Process, RunsUntilItsEndThoughNobodyWaitedForIt) {
  const pid_t child = forkOne();
  const std::uint64_t began = processBegan(child);
  EXPECT_TRUE(isRunning(child, began));
  EXPECT_TRUE(isRunning(child, 0));
  EXPECT_FALSE(isRunning(child, began + 1));  // another of that number
  kill(child, SIGKILL);
  siginfo_t end{};
  waitid(P_PID, static_cast<id_t>(child), &end, WEXITED | WNOWAIT);
  EXPECT_FALSE(isRunning(child, began));
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(isRunning(child, began));
}

}  // namespace
}  // namespace baton::dds
