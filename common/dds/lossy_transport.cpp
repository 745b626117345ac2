#include "dds/lossy_transport.hpp"

#include <atomic>
#include <chrono>
#include <utility>

#include "base/splitmix64.hpp"

namespace baton::dds {
namespace {
using fastdds::Datagram;
namespace rtps = fastdds::rtps;
namespace transport = fastdds::transport;

/// Scatters the losses over the datagrams of this process. A datagram that is sent again counts as a new one.
bool isLost(std::uint64_t one_in) {
  static std::atomic<std::uint64_t> count{0};
  return splitmix(++count * kSplitmixStep) % one_in == 0;
}

struct Descriptor final : transport::ChainingTransportDescriptor {
  Descriptor(std::uint64_t one_in_in, std::shared_ptr<transport::TransportDescriptorInterface> below)
      : ChainingTransportDescriptor(std::move(below)), one_in(one_in_in) {}
  [[nodiscard]] transport::TransportInterface* create_transport() const override;
  std::uint64_t one_in;
};

class LossyTransport final : public transport::ChainingTransport {
 public:
  explicit LossyTransport(const Descriptor& descriptor) : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  /// One call is a datagram to each of the destinations: each has its own luck.
  bool send(rtps::SenderResource* below, Datagram datagram, std::uint32_t size, rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& latest) override {
    bool is_sent = true;
    for (; *begin != *end; ++*begin) {
      if (isLost(descriptor_.one_in)) continue;
      rtps::LocatorList_t destination;
      destination.push_back(**begin);
      rtps::Locators first(destination.begin()), last(destination.end());
      is_sent = below->send(datagram, size, &first, &last, latest) && is_sent;
    }
    return is_sent;
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  Descriptor descriptor_;
};

transport::TransportInterface* Descriptor::create_transport() const { return new LossyTransport(*this); }

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> losing(
    std::uint64_t one_in, std::shared_ptr<transport::TransportDescriptorInterface> below) {
  return std::make_shared<Descriptor>(one_in, std::move(below));
}

}  // namespace baton::dds
