/// Signals that ask a program to end: Ctrl-C, Ctrl-\, SIGTERM, and SIGHUP when its terminal is closed.
#pragma once

#include <csignal>
#include <vector>

namespace baton {

/// Those that this process is to end in order on. One that `nohup`, or a shell without job control, had ignored stays
/// ignored.
[[nodiscard]] inline std::vector<int> endingSignals() {
  std::vector<int> signals{SIGINT, SIGTERM};
  for (const int number : {SIGHUP, SIGQUIT}) {
    struct sigaction now {};
    sigaction(number, nullptr, &now);
    if (now.sa_handler != SIG_IGN) signals.push_back(number);
  }
  return signals;
}

/// Keeps them waiting while a program is not yet able to end in order.
class HeldSignals {
 public:
  HeldSignals() {
    sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) sigaddset(&set_, number);
    sigprocmask(SIG_BLOCK, &set_, nullptr);
  }
  ~HeldSignals() { release(); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  /// What came meanwhile is delivered now, to this thread.
  void release() const { sigprocmask(SIG_UNBLOCK, &set_, nullptr); }

 private:
  sigset_t set_{};
};

}  // namespace baton
