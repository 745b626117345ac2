/// Counts heap allocations of the current thread: malloc and its kin, so operator new and Eigen's too.
///
///   AllocationGuard guard;
///   step();
///   EXPECT_EQ(guard.count(), 0u);
///
/// Sanitizers bring a malloc of their own; built with one, the guard is not active and counts zero.
#pragma once

#include <cstddef>

namespace baton::test {

class AllocationGuard {
 public:
  AllocationGuard() noexcept;

  /// Allocations of this thread since the guard was made.
  [[nodiscard]] std::size_t count() const noexcept;

  [[nodiscard]] static bool isActive() noexcept;

 private:
  std::size_t start_;
};

}  // namespace baton::test
