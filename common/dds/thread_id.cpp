// Debian builds Fast DDS 2.9.1 with its assertions on, and some of them ask the kernel for the id of the calling
// thread: eleven system calls for each sample that a reliable reader takes, a third of all the time a step of the loop
// takes. A thread's id never changes, so this process asks once. The executable's `syscall` comes before the C
// library's.
#include "dds/thread_id.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdarg>

namespace {

using Syscall = long (*)(long, ...);
thread_local long own_id = 0;

/// The C library's. No static local: what guards those may call syscall() itself.
Syscall next() noexcept {
  static std::atomic<Syscall> found{nullptr};
  Syscall function = found.load(std::memory_order_relaxed);
  if (function == nullptr) {
    function = reinterpret_cast<Syscall>(dlsym(RTLD_NEXT, "syscall"));
    found.store(function, std::memory_order_relaxed);
  }
  return function;
}

}  // namespace

// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name): the header has a reserved one
extern "C" long syscall(long number, ...) noexcept {
  if (number == SYS_gettid && own_id != 0) return own_id;
  va_list arguments;
  va_start(arguments, number);
  long values[6];
  for (long& value : values) value = va_arg(arguments, long);
  va_end(arguments);
  const long result = next()(number, values[0], values[1], values[2], values[3], values[4], values[5]);
  if (number == SYS_gettid) own_id = result;
  return result;
}

namespace baton::dds {

void rememberThreadIds() noexcept {
  // A child of fork() is another thread with the same memory.
  static const int registered = pthread_atfork(nullptr, nullptr, [] { own_id = 0; });
  (void)registered;
}

}  // namespace baton::dds
