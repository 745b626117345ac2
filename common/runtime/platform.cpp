#include "runtime/platform.hpp"

#include <gnu/libc-version.h>
#include <spdlog/fmt/fmt.h>
#include <sys/utsname.h>

#include <Eigen/Core>
#include <fstream>

#include "base/elementary.hpp"
#include "dds/participant.hpp"

namespace baton {

std::string processorName() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  utsname host{};
  (void)uname(&host);
  return host.machine;
}

std::map<std::string, std::string> platform() {
  return {{"mathematics", fmt::format("{}, Eigen {}.{}.{}", elementary::library(), EIGEN_WORLD_VERSION,
                                      EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"libc", fmt::format("glibc {}", gnu_get_libc_version())},
          {"dds", dds::productName()},
          {"processor", processorName()}};
}

}  // namespace baton
