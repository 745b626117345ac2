/// A DDS domain for the tests of one process.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

namespace baton::test {

/// The same for the life of this process, and no other test process of this network has it: a name in its abstract
/// socket namespace says so, which the kernel frees whatever ends the process. From 1 to 99: those ports are below the
/// ones that the kernel hands out.
/// @throws std::runtime_error  when all are taken.
[[nodiscard]] inline int ownDomain() {
  static const int domain = [] {
    constexpr int kDomains = 99;
    for (int tried = 0; tried < kDomains; ++tried) {
      const int candidate = 1 + (static_cast<int>(getpid()) + tried) % kDomains;
      const std::string name = "baton-test-domain-" + std::to_string(candidate);
      sockaddr_un address{};
      address.sun_family = AF_UNIX;
      name.copy(address.sun_path + 1, sizeof address.sun_path - 1);  // after a zero byte: no file
      const int holder = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
      if (::bind(holder, reinterpret_cast<const sockaddr*>(&address), length) == 0) return candidate;
      if (errno != EADDRINUSE) throw std::runtime_error(std::string("no domain: ") + std::strerror(errno));
      close(holder);
    }
    throw std::runtime_error("all " + std::to_string(kDomains) + " domains for tests are taken");
  }();
  return domain;
}

}  // namespace baton::test
