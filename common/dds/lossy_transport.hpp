/// A transport that loses some of what it is given to send. Private to common/dds.
#pragma once

#include <cstdint>
#include <memory>

#include "dds/fastdds.hpp"

namespace baton::dds {

/// `below` without one in `one_in` of the datagrams that this process sends, on average; scattered, and the same ones
/// whenever it sends as many.
[[nodiscard]] std::shared_ptr<fastdds::transport::TransportDescriptorInterface> losing(
    std::uint64_t one_in, std::shared_ptr<fastdds::transport::TransportDescriptorInterface> below);

}  // namespace baton::dds
