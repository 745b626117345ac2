// deploy/baton in a checkout of this test's own, where the program and cmake only say that they were called.
#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

#include "support/processes.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

class Deploy : public ::testing::Test {
 protected:
  Deploy() {
    for (const char* name : {"deploy", "tools", ".build/release/bin"}) fs::create_directories(bench_.folder() / name);
    fs::copy_file(deployFolder() / "baton", bench_.folder() / "deploy/baton");
    program("deploy/setup", "exit 0");
    program("tools/cmake", "echo \"built $*\" >&2");
    program(".build/release/bin/baton", "echo \"ran $*\"");
    std::ignore = bench_.write(".build/release/build.ninja", "");
  }
  void program(const std::string& name, const std::string& script) const {
    fs::permissions(bench_.write(name, "#!/bin/sh\n" + script + "\n"), fs::perms::owner_all);
  }
  [[nodiscard]] Finished baton(const std::string& arguments) const {
    const std::string folder = bench_.folder().string();
    return runProgram(
        "/bin/sh",
        {"-c", "unset BATON_PRESET; PATH='" + folder + "/tools':\"$PATH\" '" + folder + "/deploy/baton' " + arguments},
        folder);
  }

  Bench bench_;
};

TEST_F(Deploy, WhatSpeaksToARunBuildsNothingFirst) {
  for (const char* command :
       {"status", "swap pd", "param set pd kp=1", "sim pause", "controllers", "controller stop pd", "record stop",
        "record status --json", "logs plant", "player stop", "down"}) {
    const Finished finished = baton(command);
    EXPECT_EQ(finished.out, std::string("ran ") + command + "\n") << finished.err;
    EXPECT_EQ(finished.err.find("built"), std::string::npos) << command;
  }
}

TEST_F(Deploy, WhatStartsAProgramStartsTheOneOfTheSourcesAsTheyAre) {
  for (const char* command :
       {"run demo", "up demo", "controller start pd", "record traffic all.mcap", "replay a.mcap"}) {
    const Finished finished = baton(command);
    EXPECT_EQ(finished.out, std::string("ran ") + command + "\n") << finished.err;
    EXPECT_NE(finished.err.find("built"), std::string::npos) << command;
  }
}

}  // namespace
}  // namespace baton::test
