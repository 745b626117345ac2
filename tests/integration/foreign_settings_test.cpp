// A user who works with other DDS systems as well: what their settings ask for changes nothing in a run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "support/processes.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

/// A profile under which no participant finds another: discovery is switched off.
const std::string kNoDiscovery =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="default" is_default_profile="true">
    <rtps><builtin><discovery_config><discoveryProtocol>NONE</discoveryProtocol></discovery_config></builtin></rtps>
  </participant>
</profiles>
)";

/// A variable in the environment of this process and of those that it starts, while this lives.
class Variable {
 public:
  Variable(std::string name, const std::string& value) : name_(std::move(name)) {
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~Variable() { unsetenv(name_.c_str()); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  std::string name_;
};

void expectAnOrdinaryRun(const Bench& bench) {
  const Finished run = bench.baton({"run", bench.write("short.yaml", shortContact()), "--no-recording", "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}

class ForeignSettings : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(ForeignSettings, ChangeNothing) {
  const Bench bench;
  const auto& [name, value] = GetParam();
  (void)bench.write("profiles.xml", kNoDiscovery);
  (void)bench.write("more.json", R"({"environment_variables": {"ROS_DISCOVERY_SERVER": "127.0.0.1:11811"}})");
  const std::string given = value;
  const bool is_file = given.find('.') != std::string::npos && given.find(':') == std::string::npos;
  const Variable variable(name, is_file ? (bench.folder() / given).string() : given);
  expectAnOrdinaryRun(bench);
}

INSTANTIATE_TEST_SUITE_P(Each, ForeignSettings,
                         ::testing::Values(std::pair{"ROS_DISCOVERY_SERVER", "127.0.0.1:11811"},
                                           std::pair{"FASTRTPS_DEFAULT_PROFILES_FILE", "profiles.xml"},
                                           std::pair{"FASTDDS_DEFAULT_PROFILES_FILE", "profiles.xml"},
                                           std::pair{"FASTDDS_ENVIRONMENT_FILE", "more.json"},
                                           std::pair{"FASTDDS_BUILTIN_TRANSPORTS", "SHM"}),
                         [](const auto& param) { return param.param.first; });

TEST(ForeignSettingsFile, InTheWorkingDirectoryChangesNothing) {
  const Bench bench;
  const Variable not_skipped("SKIP_DEFAULT_XML_FILE", "0");
  for (const char* name : {"DEFAULT_FASTRTPS_PROFILES.xml", "DEFAULT_FASTDDS_PROFILES.xml"}) {
    (void)bench.write(name, kNoDiscovery);
  }
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(bench.folder());
  expectAnOrdinaryRun(bench);
  std::filesystem::current_path(before);
}

}  // namespace
}  // namespace baton::test
