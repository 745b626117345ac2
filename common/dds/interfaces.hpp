/// The machine's network interfaces, as people name them.
#pragma once

#include <string>
#include <vector>

namespace baton::dds {

/// One IPv4 address of an interface that is up.
struct Interface {
  std::string name;     // "eth0"
  std::string address;  // "192.0.2.2"
};
[[nodiscard]] std::vector<Interface> interfaces();

/// Where Baton's own processes are, unless they are asked to be elsewhere.
inline constexpr const char* kLoopback = "127.0.0.1";

/// The addresses of those that are wanted, by name or address; none when nothing is, for all of the machine. Throws
/// UsageError, naming those that are there, for one that is not; the loopback's address need not be there.
[[nodiscard]] std::vector<std::string> addressesOf(const std::vector<std::string>& wanted,
                                                   const std::vector<Interface>& there);

/// Throws UnavailableError when none of the addresses is there; of no address, for all of the machine, when nothing is.
/// Fast DDS would join the domain without a network.
void expectUp(const std::vector<std::string>& addresses, const std::vector<Interface>& there);

}  // namespace baton::dds
