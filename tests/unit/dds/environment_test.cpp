/// Settings of other DDS systems.
#include "dds/environment.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace baton::dds {
namespace {

TEST(EnvironmentTest, SettingsOfOtherSystemsAreGone) {
  const std::initializer_list<const char*> foreign{
      "ROS_DISCOVERY_SERVER",     "ROS_SUPER_CLIENT",           "FASTRTPS_DEFAULT_PROFILES_FILE",
      "FASTDDS_ENVIRONMENT_FILE", "FASTDDS_BUILTIN_TRANSPORTS", "FASTDDS_DEFAULT_PROFILES_FILE",
      "FASTDDS_STATISTICS"};
  for (const char* name : foreign) ASSERT_EQ(setenv(name, "127.0.0.1:11811", 1), 0);
  ASSERT_EQ(setenv("SKIP_DEFAULT_XML_FILE", "0", 1), 0);
  ASSERT_EQ(setenv("BATON_LOSE_ONE_IN", "50", 1), 0);
  ignoreForeignSettings();
  for (const char* name : foreign) EXPECT_EQ(std::getenv(name), nullptr) << name;
  EXPECT_STREQ(std::getenv("SKIP_DEFAULT_XML_FILE"), "1");
  EXPECT_STREQ(std::getenv("BATON_LOSE_ONE_IN"), "50") << "that one is ours";
  unsetenv("BATON_LOSE_ONE_IN");
}

}  // namespace
}  // namespace baton::dds
