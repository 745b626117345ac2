#include "runtime/processes.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>

#include "dds/process.hpp"

namespace baton {
namespace {

dds::Peer process(int pid) {
  dds::Peer peer;
  peer.pid = pid;
  peer.process_began = dds::processBegan(pid);
  return peer;
}

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
  EXPECT_TRUE(isRunning(process(getpid())));
  EXPECT_FALSE(isRunning(process(0)));
  EXPECT_FALSE(isRunning(process(-1)));
  const pid_t child = startChild();
  const dds::Peer peer = process(child);
  EXPECT_NE(peer.process_began, 0U);
  EXPECT_TRUE(isRunning(peer));
  killChild(child);
  EXPECT_FALSE(isRunning(peer));
}

TEST(Processes, HaveEndedAlsoBeforeTheirParentHasLooked) {
  const pid_t child = startChild();
  ASSERT_EQ(kill(child, SIGKILL), 0);
  siginfo_t info{};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);
  EXPECT_FALSE(isRunning(process(child)));
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
}

TEST(Processes, AreNotOthersThatHaveTheirNumber) {
  dds::Peer peer = process(getpid());
  --peer.process_began;
  EXPECT_FALSE(isRunning(peer));
}

TEST(WhenEnded, CallsBackOnce) {
  boost::asio::io_context executor;
  int calls = 0;
  const pid_t child = startChild();
  whenEnded(executor, process(child), [&] { ++calls; });
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
  whenEnded(executor, process(child), [&] { ++calls; });
  EXPECT_EQ(calls, 0) << "not within the call";
  executor.run();
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace baton
