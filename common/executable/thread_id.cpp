// Debian builds Fast DDS 2.9.1 and 3.1.2 with their assertions on. Some of these ask the kernel for the id of the
// calling thread: eleven system calls for each sample that a reliable reader takes, a third of the time of a step. A
// thread's id never changes, so a process with this `syscall` asks once per thread. The dynamic linker finds the
// executable's `syscall` before the C library's; a library must not carry it.
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

// A child of fork() is another thread with the same memory.
[[maybe_unused]] const int kRegistered = pthread_atfork(nullptr, nullptr, [] { own_id = 0; });

}  // namespace

// Like the C library it takes six arguments, however many there are: the sanitizer would see it read beyond them.
// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name): the header has a reserved one
extern "C" [[gnu::no_sanitize_address]] long syscall(long number, ...) noexcept {
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
