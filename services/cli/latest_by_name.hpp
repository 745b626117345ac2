/// What several services of a run say on one status topic, by the name in each sample.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "cell_client.hpp"

namespace baton {

/// Latest sample of each name, once all the expected ones have spoken.
template <class T>
std::map<std::string, T> latestByName(CellClient& client, const dds::Topic<T>& topic,
                                      const std::vector<std::string>& expected) {
  const auto byName = [](const std::vector<T>& all) {
    std::map<std::string, T> latest;
    for (const T& one : all) {
      T& known = latest[one.name().c_str()];
      if constexpr (std::is_same_v<T, msg::ServiceStatus>) {
        // Another process tells of a death, so its word may come before or after those of a successor.
        if (one.state() == msg::SERVICE_FAILED && known.pid() != 0 && known.pid() != one.pid()) continue;
        if (known.state() == msg::SERVICE_FAILED && known.pid() == one.pid()) continue;
      }
      known = one;
    }
    return latest;
  };
  const auto hasAll = [&](const std::vector<T>& all) {
    const auto latest = byName(all);
    return std::all_of(expected.begin(), expected.end(), [&](const auto& name) { return latest.contains(name); });
  };
  return byName(client.collect<T>(
      topic, hasAll, CellClient::kStatusPatience,
      [&](const T& one, const dds::RawSample& sample) { return client.speaksFor(sample, one.name().c_str()); }));
}

}  // namespace baton
