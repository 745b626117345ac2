// The `syscall` of common/executable, which this program is linked with.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <dlfcn.h>

#include <cerrno>
#include <filesystem>
#include <thread>

namespace baton {
namespace {

/// Or the other tests ask the C library, and prove nothing.
TEST(ThreadId, IsAskedOfThisProgram) {
  Dl_info found{};
  ASSERT_NE(dladdr(dlsym(RTLD_DEFAULT, "syscall"), &found), 0);
  EXPECT_TRUE(std::filesystem::equivalent(found.dli_fname, "/proc/self/exe")) << found.dli_fname;
}

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
