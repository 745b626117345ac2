/// One plant in a cell at a time, by a lock that the kernel lets go with the process.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "base/error.hpp"
#include "runtime/cell.hpp"

namespace baton {
namespace {

class PlantLockTest : public testing::Test {
 protected:
  PlantLockTest() { use(home_); }
  ~PlantLockTest() override { std::filesystem::remove_all(home_); }
  static void use(const std::filesystem::path& home) { ::setenv("BATON_HOME", home.c_str(), 1); }

  const std::filesystem::path home_ =
      std::filesystem::temp_directory_path() / ("baton-plant-lock-" + std::to_string(::getpid()));
};

TEST_F(PlantLockTest, APlantOfAnotherRunIsRefusedAndNamed) {
  std::optional<PlantLock> first(std::in_place, 3, "lab", "run-1");
  try {
    const PlantLock second(3, "lab", "run-2");
    FAIL() << "the cell has a plant";
  } catch (const UnavailableError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("a plant of run run-1 already, process " + std::to_string(::getpid())), std::string::npos)
        << text;
  }
  EXPECT_NO_THROW(PlantLock(3, "other", "run-2"));
  EXPECT_NO_THROW(PlantLock(4, "lab", "run-2"));
  first.reset();
  EXPECT_NO_THROW(PlantLock(3, "lab", "run-2"));
}

TEST_F(PlantLockTest, ASecondOneOfTheSameRunIsLeftToDiscovery) {
  const PlantLock first(3, "lab", "run-1");
  EXPECT_NO_THROW(PlantLock(3, "lab", "run-1"));
}

TEST_F(PlantLockTest, WithoutAFolderForItThereIsNone) {
  std::ofstream(home_) << "a file";
  EXPECT_NO_THROW(PlantLock(3, "lab", "run-1"));
}

}  // namespace
}  // namespace baton
