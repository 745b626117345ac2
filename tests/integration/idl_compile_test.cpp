// idl/compile.sh with fastddsgen, and with scripts in its place.
#include <gtest/gtest.h>

#include <filesystem>

#include "support/processes.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

class IdlCompile : public ::testing::Test {
 protected:
  IdlCompile() {
    fs::create_directories(idl_);
    for (const auto& file : fs::directory_iterator(checkoutFolder() / "idl")) {
      if (file.path().extension() == ".idl") fs::copy_file(file, idl_ / file.path().filename());
    }
    fs::create_directory(bench_.folder() / "tools");
  }
  /// @param script  what fastddsgen does: "$real" is the one that is installed.
  void fastddsgenThat(const std::string& script) const {
    fs::permissions(
        bench_.write("tools/fastddsgen", "#!/bin/sh\nreal=$(PATH=$old command -v fastddsgen)\n" + script + "\n"),
        fs::perms::owner_all);
  }
  [[nodiscard]] Finished compile(const std::string& settings = "") const {
    return runProgram(
        "/bin/sh",
        {"-c", "old=$PATH PATH='" + (bench_.folder() / "tools").string() + "':\"$PATH\" " + settings + " '" +
                   (checkoutFolder() / "idl/compile.sh").string() + "' fastdds '" + (idl_ / "parameter.idl").string() +
                   "' '" + idl_.string() + "' '" + made_.string() + "'"},
        bench_.folder());
  }

  const Bench bench_;
  const fs::path idl_ = bench_.folder() / "an error, a warning" / "exceptions";
  const fs::path made_ = bench_.folder() / "made";
};

TEST_F(IdlCompile, FoldersMayHaveAnyNameAndJavaAnyOptions) {
  const Finished finished = compile("JAVA_TOOL_OPTIONS=-XX:+HeapDumpOnOutOfMemoryError BATON_WARNINGS_AS_ERRORS=ON");
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(fs::exists(made_ / "parameter.h"));
}

TEST_F(IdlCompile, AWarningStopsDevelopersOnly) {
  fastddsgenThat(R"("$real" "$@"; echo 'WARNING: a method of this Java is going to be removed')");
  const Finished told = compile();
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.err.find("is going to be removed"), std::string::npos) << told.err;
  EXPECT_EQ(compile("BATON_WARNINGS_AS_ERRORS=ON").exit_code, 1);
}

TEST_F(IdlCompile, AnExceptionIsAnErrorWhateverTheExitCode) {
  ASSERT_EQ(compile().exit_code, 0);
  fastddsgenThat(R"("$real" "$@"; echo 'java.lang.NullPointerException'; exit 0)");
  EXPECT_EQ(compile().exit_code, 1);
}

/// What is changed in the generated code is counted.
TEST_F(IdlCompile, CodeThatIsWrittenInAnotherWayStopsTheBuild) {
  fastddsgenThat(R"("$real" "$@" || exit
while [ "$1" != -d ]; do shift; done
sed -i 's/resize(sequence_size)/resize(size_t{sequence_size})/; s/deserialize_type(/deserializeType(/' "$2"/*)");
  const Finished finished = compile();
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_NE(finished.err.find("expected fastddsgen to write"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace baton::test
