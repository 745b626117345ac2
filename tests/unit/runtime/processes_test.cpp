#include "runtime/processes.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>

namespace baton {
namespace {

/// A child that does nothing until it is killed.
pid_t startChild() {
  const pid_t child = fork();
  while (child == 0) pause();
  return child;
}

void killChild(pid_t child) {
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
}

TEST(Processes, RunUntilTheyEnd) {
  EXPECT_TRUE(isRunning(getpid()));
  EXPECT_FALSE(isRunning(0));
  EXPECT_FALSE(isRunning(-1));
  const pid_t child = startChild();
  EXPECT_TRUE(isRunning(child));
  killChild(child);
  EXPECT_FALSE(isRunning(child));
}

TEST(Processes, HaveEndedAlsoBeforeTheirParentHasLooked) {
  const pid_t child = startChild();
  ASSERT_EQ(kill(child, SIGKILL), 0);
  siginfo_t info{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);
  EXPECT_FALSE(isRunning(child));
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
}

TEST(Processes, SomebodyElsesDoNotCount) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can start a process as somebody else";
  const pid_t child = fork();
  if (child == 0) {
    if (setuid(65534) != 0) _exit(1);
    kill(getpid(), SIGSTOP);
    _exit(0);
  }
  siginfo_t info{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &info, WSTOPPED | WNOWAIT), 0);
  EXPECT_FALSE(isRunning(child));
  killChild(child);
}

TEST(WhenEnded, CallsBackOnce) {
  boost::asio::io_context executor;
  int calls = 0;
  const pid_t child = startChild();
  whenEnded(executor, child, [&] { ++calls; });
  executor.poll();
  EXPECT_EQ(calls, 0);
  killChild(child);
  executor.restart();
  executor.run();
  EXPECT_EQ(calls, 1);
}

TEST(WhenEnded, CallsBackForWhoHasEndedBefore) {
  boost::asio::io_context executor;
  int calls = 0;
  const pid_t child = startChild();
  killChild(child);
  whenEnded(executor, child, [&] { ++calls; });
  EXPECT_EQ(calls, 0) << "not within the call";
  executor.run();
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace baton
