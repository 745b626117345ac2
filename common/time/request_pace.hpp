/// How fast requests are taken. What is decided about a request is recorded, and a recorder on a busy machine must be
/// able to follow, however fast they come. A plain state machine that is told the time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

namespace baton {

class RequestPace {
 public:
  using Asker = std::array<std::uint8_t, 12>;
  static constexpr std::int64_t kAtOnce = 16;                     // of each asker
  static constexpr std::int64_t kInterval_ns = 10'000'000;        // between those that follow
  static constexpr std::int64_t kLongestWait_ns = 1'000'000'000;  // of a request

  /// When a request that comes now is to be taken: now or later, never before an earlier one of the same asker. Nothing
  /// when it would have to wait for too long: then it is left out.
  [[nodiscard]] std::optional<std::int64_t> admit(const Asker& asker, std::int64_t now_ns);
  /// Askers that are remembered.
  [[nodiscard]] std::size_t size() const noexcept { return even_at_.size(); }

 private:
  static constexpr std::size_t kManyAskers = 1000;  // then those that have not asked lately are forgotten
  std::map<Asker, std::int64_t> even_at_;           // when each has its kAtOnce again
};

}  // namespace baton
