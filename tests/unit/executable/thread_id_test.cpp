// The `syscall` of common/executable, which this program is linked with.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

namespace baton {
namespace {

TEST(ThreadId, IsTheKernelsInEveryThread) {
  for (int again = 0; again < 3; ++again) EXPECT_EQ(syscall(SYS_gettid), gettid());
  std::thread([] {
    for (int again = 0; again < 3; ++again) EXPECT_EQ(syscall(SYS_gettid), gettid());
  }).join();
}

TEST(ThreadId, OfAForkedChildIsItsOwn) {
  ASSERT_EQ(syscall(SYS_gettid), gettid());
  const pid_t child = fork();
  if (child == 0) _exit(syscall(SYS_gettid) == getpid() ? 0 : 1);
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(ThreadId, OtherSystemCallsPassWithTheirErrors) {
  EXPECT_EQ(syscall(SYS_getppid), getppid());
  errno = 0;
  EXPECT_EQ(syscall(SYS_close, -1), -1);
  EXPECT_EQ(errno, EBADF);
}

}  // namespace
}  // namespace baton
