/// The rule of the step protocol for a service that answers the plant: a step is computed when every declared input for
/// that step is here. DDS orders samples per writer, not across topics, so inputs of a step may come in any order and
/// the reference comes a step early.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace baton {

/// Remembers which inputs have arrived, for a window of steps. Values are the caller's business: it keeps them in
/// arrays of kWindow entries, at slot(step).
class StepInputs {
 public:
  /// How many steps a service that nobody waits for may lag behind before it loses one. As many as the plant may run
  /// ahead of the recorder.
  static constexpr std::size_t kWindow = 512;
  static constexpr std::size_t kMaxInputs = 4;

  /// @param inputs how many inputs a step needs, 1 to kMaxInputs.
  explicit StepInputs(std::size_t inputs) noexcept : inputs_(inputs) {}

  [[nodiscard]] static std::size_t slot(std::uint64_t step) noexcept { return step % kWindow; }

  /// Input `index` for `step` has arrived and is stored at slot(step). Returns true when that makes the step complete
  /// and it has not been computed yet: the caller computes it now and calls done(step). A sample older than the window
  /// of what has come already is ignored, as is one for a step already computed.
  [[nodiscard]] bool offer(std::size_t index, std::uint64_t step) noexcept;

  /// Whether a sample for `step` would still be of use; ask before overwriting the slot.
  [[nodiscard]] bool wants(std::size_t index, std::uint64_t step) const noexcept;

  /// Whether input `index` for `step` has arrived.
  [[nodiscard]] bool has(std::size_t index, std::uint64_t step) const noexcept {
    return arrived_[index][slot(step)] == step;
  }

  void done(std::uint64_t step) noexcept { last_done_ = step; }
  [[nodiscard]] std::optional<std::uint64_t> lastDone() const noexcept { return last_done_; }

 private:
  std::size_t inputs_;
  std::array<std::array<std::optional<std::uint64_t>, kWindow>, kMaxInputs> arrived_{};
  std::optional<std::uint64_t> last_done_;
};

}  // namespace baton
