#include "dds/interfaces.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <memory>

#include "base/error.hpp"

namespace baton::dds {
namespace {

std::string textOf(const std::vector<Interface>& there) {
  std::string list;
  for (const Interface& one : there) list += (list.empty() ? "" : ", ") + one.name + " (" + one.address + ")";
  return list.empty() ? "none" : list;
}

}  // namespace

std::vector<Interface> interfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(first, &freeifaddrs);
  std::vector<Interface> found;
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET || (one->ifa_flags & IFF_UP) == 0) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    if (inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) == nullptr) continue;
    found.push_back({one->ifa_name, text.data()});
  }
  return found;
}

std::vector<std::string> addressesOf(const std::vector<std::string>& wanted, const std::vector<Interface>& there) {
  std::vector<std::string> addresses;
  for (const std::string& one : wanted) {
    if (one == "all") return {};
    if (one == kLoopback) {
      addresses.push_back(one);
      continue;
    }
    const std::size_t before = addresses.size();
    for (const Interface& known : there) {
      if (one == known.name || one == known.address) addresses.push_back(known.address);
    }
    if (addresses.size() > before) continue;
    expectUp({}, there);
    throw UsageError("--interface: expected all or one of " + textOf(there) + ", found " + one);
  }
  return addresses;
}

void expectUp(const std::vector<std::string>& addresses, const std::vector<Interface>& there) {
  const auto isWanted = [&](const Interface& one) {
    return addresses.empty() || std::ranges::count(addresses, one.address) > 0;
  };
  if (std::ranges::any_of(there, isWanted)) return;
  std::string wanted;
  for (const std::string& one : addresses) wanted += (wanted.empty() ? " with the address " : " or ") + one;
  throw UnavailableError("DDS has no network: expected an interface" + wanted + " that is up, found " + textOf(there) +
                         "; bring it up (the loopback: ip link set lo up) and retry");
}

}  // namespace baton::dds
