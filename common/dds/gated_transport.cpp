#include "dds/gated_transport.hpp"

#include <chrono>
#include <span>
#include <utility>

namespace baton::dds {
namespace {
using fastdds::Datagram;
namespace rtps = fastdds::rtps;
namespace transport = fastdds::transport;

/// RTPS 2.5, 9.6.2: of the ports of a participant those of discovery are even and the others odd.
bool isOfDiscovery(const rtps::Locator_t& local) { return local.port % 2 == 0; }

std::int64_t now_ns() { return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct GatedDescriptor final : transport::ChainingTransportDescriptor {
  GatedDescriptor(std::shared_ptr<Gate> gate_in, std::shared_ptr<transport::TransportDescriptorInterface> below)
      : ChainingTransportDescriptor(std::move(below)), gate(std::move(gate_in)) {}
  [[nodiscard]] transport::TransportInterface* create_transport() const override;
  std::shared_ptr<Gate> gate;
};

class GatedTransport final : public transport::ChainingTransport {
 public:
  explicit GatedTransport(const GatedDescriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* below, Datagram datagram, std::uint32_t size, rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& latest) override {
    return below->send(datagram, size, begin, end, latest);
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    if (!isOfDiscovery(local) && !descriptor_.gate->admits(std::as_bytes(std::span(bytes, size)), now_ns())) return;
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  GatedDescriptor descriptor_;
};

transport::TransportInterface* GatedDescriptor::create_transport() const { return new GatedTransport(*this); }

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> gated(
    std::shared_ptr<Gate> gate, std::shared_ptr<transport::TransportDescriptorInterface> below) {
  return std::make_shared<GatedDescriptor>(std::move(gate), std::move(below));
}

}  // namespace baton::dds
