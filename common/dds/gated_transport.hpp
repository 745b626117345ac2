/// A transport behind a gate. Private to common/dds.
#pragma once

#include <memory>

#include "dds/fastdds.hpp"
#include "dds/gate.hpp"

namespace baton::dds {

/// `below`, but what comes to readers and writers of the program is handed on only when the gate admits it. Discovery
/// has ports of its own, where everybody is heard.
[[nodiscard]] std::shared_ptr<fastdds::transport::TransportDescriptorInterface> gated(
    std::shared_ptr<Gate> gate, std::shared_ptr<fastdds::transport::TransportDescriptorInterface> below);

}  // namespace baton::dds
