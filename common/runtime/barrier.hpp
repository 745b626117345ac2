/// The start barrier: a service is ready when each of its endpoints is matched with every service that must be on the
/// other side. Writer and reader may see a match at different times, so both sides hold one of these, and the plant
/// starts when all services say they are ready.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/participant.hpp"

namespace baton {

class Barrier {
 public:
  explicit Barrier(const dds::Participant& participant) : participant_(participant) {}

  /// `matched` gives the participants an endpoint on `topic` is matched with; all services in `peers` must be among
  /// them.
  void require(const std::string& topic, std::function<std::set<dds::GuidPrefix>()> matched,
               std::vector<std::string> peers);

  /// The eldest process of that name among those the endpoints are matched with.
  [[nodiscard]] std::optional<dds::Peer> eldest(const std::string& service) const;

  /// What is still missing, "plant_state: environment, recorder; ...", or empty when ready.
  [[nodiscard]] std::string missing() const;

 private:
  struct Requirement {
    std::string topic;
    std::function<std::set<dds::GuidPrefix>()> matched;
    std::vector<std::string> peers;
  };
  const dds::Participant& participant_;
  std::vector<Requirement> requirements_;
};

}  // namespace baton
