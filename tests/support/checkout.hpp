/// Where this checkout is, for tests that read its files.
#pragma once

#include <filesystem>

namespace baton::test {

inline std::filesystem::path checkoutFolder() {
  return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
}

/// What users are given: scenarios, robots, figures.
inline std::filesystem::path deployFolder() { return checkoutFolder() / "deploy"; }

}  // namespace baton::test
