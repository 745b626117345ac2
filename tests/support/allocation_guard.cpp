#include "support/allocation_guard.hpp"

#include <cerrno>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define BATON_COUNTS_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define BATON_COUNTS_ALLOCATIONS 0
#endif
#endif
#ifndef BATON_COUNTS_ALLOCATIONS
#define BATON_COUNTS_ALLOCATIONS 1
#endif

namespace {
constinit thread_local std::size_t allocations = 0;
}  // namespace

#if BATON_COUNTS_ALLOCATIONS
// The executable's own malloc family takes precedence over glibc's, for every library of the process. Each one counts
// and passes on; free needs no stand-in. The names are the C library's.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {
void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t count, std::size_t size) noexcept;
void* __libc_realloc(void* block, std::size_t size) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t size) noexcept;

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept { return memalign(alignment, size); }

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  const bool is_power_of_two = alignment != 0 && (alignment & (alignment - 1)) == 0;
  if (!is_power_of_two || alignment % sizeof(void*) != 0) return EINVAL;
  void* const result = memalign(alignment, size);
  if (result == nullptr) return ENOMEM;
  *block = result;
  return 0;
}
}  // extern "C"
// NOLINTEND(readability-identifier-naming)
#endif

namespace baton::test {

AllocationGuard::AllocationGuard() noexcept : start_(allocations) {}

std::size_t AllocationGuard::count() const noexcept { return allocations - start_; }

bool AllocationGuard::isActive() noexcept { return BATON_COUNTS_ALLOCATIONS != 0; }

}  // namespace baton::test
