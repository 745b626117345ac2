/// Files that cannot be used are refused with the system's reason.
#include "runtime/paths.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.hpp"
#include "runtime/log.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

class Paths : public testing::Test {
 protected:
  Paths() { fs::create_directories(folder); }
  ~Paths() override { fs::remove_all(folder); }

  /// What the call is refused with.
  template <class Call>
  static std::string refusal(const Call& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    ADD_FAILURE() << "expected an Error, found none";
    return "";
  }
  static void expectIn(const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  const fs::path folder = fs::temp_directory_path() / ("baton-paths-" + std::to_string(getpid()));
  const std::string long_name = std::string(300, 'a');
};

TEST_F(Paths, AFileThatCannotBeReadHasTheSystemsReason) {
  expectIn(refusal([&] { (void)readFile(folder / "none"); }), "none: No such file or directory");
  expectIn(refusal([&] { (void)readFile(folder); }), ": Is a directory");
  expectIn(refusal([&] { (void)readFile(folder / long_name); }), ": File name too long");
  expectIn(refusal([&] { (void)readYamlFile(folder); }), ": expected a file, found a folder");
  EXPECT_EQ(lastLines(folder / "none.log", 3), "  cannot be read: No such file or directory\n");
}

TEST_F(Paths, AFileThatCannotBeWrittenHasTheSystemsReason) {
  writeFile(folder / "a", "one");
  writeFile(folder / "a", "two\n");
  EXPECT_EQ(readFile(folder / "a"), "two\n");
  int error = -1;
  EXPECT_EQ(readFile(folder / "a", 2, error), "tw");
  EXPECT_EQ(error, 0);
  expectIn(refusal([&] { writeFile(folder / "none/a", ""); }), ": No such file or directory");
  expectIn(refusal([&] { writeFile(folder / "a/b", ""); }), ": Not a directory");
  expectIn(refusal([&] { writeFile(folder / long_name, ""); }), ": File name too long");
  expectIn(refusal([&] { writeFile("/dev/full", "a"); }), ": No space left on device");
}

TEST_F(Paths, AFolderThatIsNotThereIsEmptyAndOneThatCannotBeReadIsNot) {
  writeFile(folder / "a", "");
  EXPECT_EQ(listFolder(folder), std::vector<fs::path>{folder / "a"});
  EXPECT_TRUE(listFolder(folder / "none").empty());
  expectIn(refusal([&] { (void)listFolder(folder / "a"); }), "cannot read the folder");
  expectIn(refusal([&] { (void)listFolder(folder / "a"); }), ": Not a directory");
}

TEST_F(Paths, AnOutputIsToldWhatIsInThePlaceOfItsFolder) {
  writeFile(folder / "a", "");
  expectIn(refusal([&] { (void)outputPath((folder / "none/a.mcap").string()); }), "/none is none");
  expectIn(refusal([&] { (void)outputPath((folder / "a/a.mcap").string()); }), "/a is a file");
}

/// Root may read everything.
TEST_F(Paths, WhatMayNotBeReadIsNotSaidToBeMissing) {
  if (getuid() == 0) GTEST_SKIP() << "root may read everything";
  writeFile(folder / "a", "");
  ASSERT_EQ(::chmod(folder.c_str(), 0), 0);
  expectIn(refusal([&] { (void)readFile(folder / "a"); }), ": Permission denied");
  expectIn(refusal([&] { (void)listFolder(folder); }), ": Permission denied");
  expectIn(refusal([&] { (void)outputPath((folder / "b/a.mcap").string()); }), "Permission denied");
  ASSERT_EQ(::chmod(folder.c_str(), 0700), 0);
}

}  // namespace
}  // namespace baton
