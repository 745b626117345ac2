// Fuzz target: a datagram of a stranger, at the gate of a run. What is let in does nothing but ask.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "dds/gate.hpp"

namespace {

using namespace baton;

/// RTPS: kinds of submessages up to the end of the message, by their lengths.
bool onlyAsks(std::span<const std::uint8_t> message) {
  std::size_t at = 20;
  while (message.size() >= at + 4) {
    const std::uint8_t kind = message[at];
    if (kind < 0x80 && kind != 0x01 && kind != 0x06 && kind != 0x09 && kind != 0x0e && kind != 0x12) return false;
    const bool is_little = (message[at + 1] & 1) != 0;
    const std::size_t length =
        is_little ? message[at + 2] + 256U * message[at + 3] : message[at + 3] + 256U * message[at + 2];
    if (length == 0 && kind != 0x01 && kind != 0x09) return true;  // up to the end
    at += 4 + ((length + 3) & ~std::size_t{3});                    // as Fast DDS does
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const dds::RunKey key = *dds::RunKey::parse(std::string(64, '5'));
  dds::Gate gate(key, dds::Strangers::kAskFreely, {});
  const std::span<const std::uint8_t> message(data, size);
  const bool is_admitted = gate.admits(std::as_bytes(message), 0);
  if (is_admitted && !onlyAsks(message)) std::abort();
  if (is_admitted != (gate.turnedAway() == 0)) std::abort();
  return 0;
}
