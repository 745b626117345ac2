#include "runtime/log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace baton {
namespace {

/// The DDS library logs names of others as they are.
TEST(Log, IsShownSoThatItChangesNoTerminal) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("baton-log-" + std::to_string(getpid()) + ".log");
  std::ofstream(file) << "12:00 info plant: ready\n12:01 error dds: topic \x1b[2J\a refused\n";
  EXPECT_EQ(lastLines(file, 1), "  12:01 error dds: topic \\x1b[2J\\x07 refused\n");
  EXPECT_EQ(lastError(file), "12:01 error dds: topic \\x1b[2J\\x07 refused");
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace baton
