/* Preloaded: the wall clock is set back by an hour and forward again ten times a second, as nothing but a user or NTP at
   its worst does. Never ahead of the kernel's, by which waits end. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>
#include <time.h>

int clock_gettime(clockid_t id, struct timespec* time) {
  static int (*real)(clockid_t, struct timespec*) = NULL;
  if (real == NULL) *(void**)(&real) = dlsym(RTLD_NEXT, "clock_gettime");
  const int result = real(id, time);
  struct timespec steady;
  if (result == 0 && id == CLOCK_REALTIME && real(CLOCK_MONOTONIC, &steady) == 0 && steady.tv_nsec / 100000000 % 2 == 1) {
    time->tv_sec -= 3600;
  }
  return result;
}
