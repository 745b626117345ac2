/// Sleeps to the microsecond, and is woken before by a ring, a key or a signal.
#pragma once

#include <atomic>
#include <cstdint>

namespace baton {

/// Nanoseconds of the clock that sleepUntil() sleeps by.
[[nodiscard]] std::int64_t steadyNow();

class Sleeper {
 public:
  /// For the thread that makes it: the kernel would round its sleeps up to 50 us.
  Sleeper();
  ~Sleeper();
  Sleeper(const Sleeper&) = delete;
  Sleeper& operator=(const Sleeper&) = delete;

  /// Ends the sleep under way, or the next one. Any thread, and signal handlers.
  void ring() noexcept;
  /// Whether somebody rang since this was asked last.
  [[nodiscard]] bool wasRung() noexcept;
  /// The same without taking notice of it.
  [[nodiscard]] bool rings() const noexcept { return was_rung_; }
  /// Returns when it is that time, or before it after a ring or when `input` (-1 for none) can be read.
  void sleepUntil(std::int64_t deadline_ns, int input);

 private:
  std::atomic<bool> was_rung_{false};
  int bell_;
};

/// From now on the first signal that asks for the end rings and is remembered; the second restores the terminal and
/// ends the process at once. For one sleeper, which lives as long as the process.
void listenToSignals(Sleeper& sleeper);
[[nodiscard]] bool isInterrupted();

}  // namespace baton
