#include "dds/environment.hpp"

#include <array>
#include <cstdlib>

namespace baton::dds {
namespace {

// All that Fast DDS 2.9.1 and 3.1.2 read, but for the PIN of a security token.
constexpr std::array<const char*, 7> kForeign{
    "ROS_DISCOVERY_SERVER",            // every participant becomes a client of that server
    "ROS_SUPER_CLIENT",                // as what it becomes one
    "FASTRTPS_DEFAULT_PROFILES_FILE",  // XML with other defaults; 2.9
    "FASTDDS_DEFAULT_PROFILES_FILE",   // 3.1
    "FASTDDS_ENVIRONMENT_FILE",        // JSON with more of these variables, read again when it changes
    "FASTDDS_BUILTIN_TRANSPORTS",      // other than UDP on loopback
    "FASTDDS_STATISTICS",              // more writers in each participant
};
// "1": DEFAULT_FASTRTPS_PROFILES.xml or DEFAULT_FASTDDS_PROFILES.xml in the working directory is not read.
constexpr const char* kSkipFile = "SKIP_DEFAULT_XML_FILE";

}  // namespace

void ignoreForeignSettings() {
  for (const char* const name : kForeign) ::unsetenv(name);
  ::setenv(kSkipFile, "1", 1);
}

}  // namespace baton::dds
