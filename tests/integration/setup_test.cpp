// deploy/setup, with an apt of this test's own: nothing is installed and nothing removed.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <tuple>

#include "runtime/paths.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

class Setup : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ifstream release("/etc/os-release");
    std::ostringstream text;
    text << release.rdbuf();
    if (text.str().find("bookworm") == std::string::npos && text.str().find("trixie") == std::string::npos) {
      GTEST_SKIP() << "deploy/setup is for Debian 12 and 13";
    }
    fs::create_directory(tools_);
    tool("dpkg-query", R"(case "$*" in *db:Status-Status*libboost1.81-dev*) echo libboost1.81-dev installed ;; esac)");
    tool("sudo", R"(exec "$@")");
    tool("fastddsgen", "");
    tool("idlc", "");
  }

  /// A program that setup finds before the system's.
  void tool(const std::string& name, const std::string& script) {
    const fs::path file = tools_ / name;
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(file, fs::perms::owner_all);
  }

  /// An apt-get that notes how it is called; `answer` is what it does besides.
  void aptThat(const std::string& answer) {
    tool("apt-get", "echo \"$@\" >>'" + calls_.string() + "'\n" + answer);
    tool("apt-cache", "printf '%s\\n' anything");
  }

  [[nodiscard]] Finished setup(const std::string& arguments, const fs::path& deploy = deployFolder()) const {
    return runProgram(
        "/bin/sh",
        {"-c", "PATH='" + tools_.string() + "':\"$PATH\" '" + (deploy / "setup").string() + "' " + arguments},
        bench_.folder());
  }

  /// The calls that only ask or read lists are left out.
  [[nodiscard]] std::vector<std::string> changingCalls() const {
    std::vector<std::string> changing;
    std::ifstream stream(calls_);
    for (std::string call; std::getline(stream, call);) {
      call = " " + call + " ";
      if (call.find(" install ") != std::string::npos && call.find(" -s ") == std::string::npos &&
          call.find(" --print-uris ") == std::string::npos) {
        changing.push_back(call);
      }
    }
    return changing;
  }

  const Bench bench_;

 private:
  const fs::path tools_ = bench_.folder() / "tools";
  const fs::path calls_ = bench_.folder() / "calls";
};

TEST_F(Setup, StopsAndNamesThePackageThatWouldHaveToGo) {
  // apt either tells what it would remove, or finds no way until it is told.
  for (const char* answer :
       {R"(case " $* " in *" --no-remove "*) exit 100 ;; *" -s "*) echo 'Remv libboost1.81-dev [1.81.0]' ;; esac)",
        R"(case " $* " in *" libboost1.81-dev- "*) echo 'Remv libboost1.81-dev [1.81.0]' ;;
              *" -s "*) echo ' libboost1.81-dev : Conflicts: libboost1.74-dev but 1.74.0 is to be installed'
                exit 100 ;;
              esac)"}) {
    aptThat(answer);
    for (const char* arguments : {"run", "--dry-run run"}) {
      const Finished finished = setup(arguments);
      EXPECT_EQ(finished.exit_code, 3) << finished.err;
      EXPECT_NE(finished.err.find("stand in the way: libboost1.81-dev\n"), std::string::npos) << finished.err;
    }
  }
  EXPECT_TRUE(changingCalls().empty()) << changingCalls().front();
}

TEST_F(Setup, TellsItsPlanThenInstallsAndForbidsToRemove) {
  aptThat(R"(case " $* " in
             *" -s "*) printf 'Inst %s (1)\n' a b c ;;
             *" --print-uris "*) echo "'http://x/a.deb' a.deb 2500000 MD5" ;;
             esac)");
  const Finished told = setup("--dry-run");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.err.find("It takes 3 packages"), std::string::npos) << told.err;
  EXPECT_NE(told.err.find("2.5 MB to download"), std::string::npos) << told.err;
  EXPECT_TRUE(changingCalls().empty()) << "a dry run";

  const Finished done = setup("");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_NE(done.err.find("It takes 3 packages"), std::string::npos) << done.err;
  ASSERT_EQ(changingCalls().size(), 1U);
  EXPECT_NE(changingCalls().front().find("--no-remove"), std::string::npos) << changingCalls().front();
}

/// apt-get update has the exit code 0 then.
TEST_F(Setup, SaysThatThePackageListsCouldNotBeRead) {
  aptThat(R"(case " $* " in
             *" update "*) echo 'W: Failed to fetch http://x/InRelease  Temporary failure resolving x' ;;
             *) echo 'E: Unable to locate package ninja-build'; exit 100 ;;
             esac)");
  for (const char* arguments : {"run", "--dry-run run"}) {
    const Finished finished = setup(arguments);
    EXPECT_EQ(finished.exit_code, 3) << finished.err;
    EXPECT_NE(finished.err.find("Temporary failure resolving x"), std::string::npos) << finished.err;
    EXPECT_NE(finished.err.find("lists could not be read"), std::string::npos) << finished.err;
  }
}

TEST_F(Setup, WhatRootInstallsInACheckoutBelongsToItsOwner) {
  fs::create_directory(bench_.folder() / "deploy");
  fs::copy_file(deployFolder() / "setup", bench_.folder() / "deploy/setup");
  fs::create_directories(bench_.folder() / "tests/interop");
  for (const char* name : {"package.json", "package-lock.json"}) {
    std::ignore = bench_.write(std::string("tests/interop/") + name, "{}");
  }
  tool("dpkg-query", R"(shift 2; for name; do echo "$name installed"; done)");
  tool("stat", "echo ann");
  tool("chown", "");
  tool("getent", "echo ann:x:1000:1000::/home/ann:/bin/sh");
  const std::string calls = (bench_.folder() / "as_ann").string();
  tool("runuser", "echo \"$@\" >>'" + calls + "'; shift 3; exec \"$@\"");
  tool("npm", "mkdir node_modules; touch node_modules/.package-lock.json; echo home $HOME >>'" + calls + "'");
  const Finished finished = setup("test", bench_.folder() / "deploy");
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(fs::exists(bench_.folder() / ".build/interop/node_modules"));
  const std::string as_owner = readFile(calls);
  for (const char* part : {"-u ann -- env HOME=/home/ann cp ", " npm ci ", "home /home/ann\n"}) {
    EXPECT_EQ(as_owner.find(part) != std::string::npos, geteuid() == 0) << part << ": " << as_owner;
  }
}

TEST_F(Setup, RefusesWordsThatItDoesNotKnow) {
  EXPECT_EQ(setup("--dry-rnu").exit_code, 2);
  EXPECT_EQ(setup("everything").exit_code, 2);
  EXPECT_EQ(setup("run test").exit_code, 2);
  EXPECT_EQ(setup("--help").exit_code, 0);
}

}  // namespace
}  // namespace baton::test
