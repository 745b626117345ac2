#include "runtime/barrier.hpp"

#include <algorithm>

namespace baton {

void Barrier::require(const std::string& topic, std::function<std::set<dds::GuidPrefix>()> matched,
                      std::vector<std::string> peers) {
  if (!peers.empty()) requirements_.push_back({topic, std::move(matched), std::move(peers)});
}

std::optional<dds::Peer> Barrier::eldest(const std::string& service) const {
  std::optional<dds::Peer> eldest;
  for (const Requirement& requirement : requirements_) {
    for (const dds::GuidPrefix& prefix : requirement.matched()) {
      const auto peer = participant_.member(prefix);
      if (peer && peer->service == service && (!eldest || isElder(*peer, *eldest))) eldest = peer;
    }
  }
  return eldest;
}

std::string Barrier::missing() const {
  std::string text;
  for (const Requirement& requirement : requirements_) {
    std::set<std::string> present;
    for (const dds::GuidPrefix& prefix : requirement.matched()) {
      if (const auto peer = participant_.member(prefix)) present.insert(peer->service);
    }
    std::string absent;
    for (const std::string& peer : requirement.peers) {
      if (!present.contains(peer)) absent += (absent.empty() ? "" : ", ") + peer;
    }
    if (!absent.empty()) text += (text.empty() ? "" : "; ") + requirement.topic + ": " + absent;
  }
  return text;
}

}  // namespace baton
