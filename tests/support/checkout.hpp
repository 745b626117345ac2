/// Where this checkout is, for tests that read its files.
#pragma once

#include <filesystem>

namespace baton::test {

[[nodiscard]] std::filesystem::path checkoutFolder();
/// What users are given: scenarios, robots, figures.
[[nodiscard]] std::filesystem::path deployFolder();

}  // namespace baton::test
