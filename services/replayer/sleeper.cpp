#include "sleeper.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "base/error.hpp"
#include "runtime/signals.hpp"
#include "terminal.hpp"

namespace baton {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::atomic<Sleeper*> listener{nullptr};
std::atomic<bool> is_interrupted{false};

void onSignal(int signal) {
  if (is_interrupted.exchange(true)) {
    restoreTerminal();
    std::signal(signal, SIG_DFL);
    raise(signal);
  }
  if (Sleeper* sleeper = listener) sleeper->ring();
}

}  // namespace

std::int64_t steadyNow() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

Sleeper::Sleeper() : bell_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (bell_ < 0) throw UnavailableError(std::string("cannot make an event: ") + std::strerror(errno));
  prctl(PR_SET_TIMERSLACK, 1);
}

Sleeper::~Sleeper() {
  Sleeper* self = this;
  listener.compare_exchange_strong(self, nullptr);
  close(bell_);
}

void Sleeper::ring() noexcept {
  const int error = errno;  // of what a signal interrupts
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(bell_, &one, sizeof one);  // full: it rings already
  errno = error;
  was_rung_ = true;  // last: who sees it empties the bell
}

bool Sleeper::wasRung() noexcept {
  if (!was_rung_.exchange(false)) return false;
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t taken = read(bell_, &count, sizeof count);
  return true;
}

void Sleeper::sleepUntil(std::int64_t deadline_ns, int input) {
  std::array<pollfd, 2> wakers{pollfd{.fd = bell_, .events = POLLIN, .revents = 0},
                               pollfd{.fd = input, .events = POLLIN, .revents = 0}};
  for (std::int64_t left_ns = deadline_ns - steadyNow(); left_ns > 0; left_ns = deadline_ns - steadyNow()) {
    if (was_rung_) return;
    const timespec left{.tv_sec = left_ns / kSecond, .tv_nsec = left_ns % kSecond};
    if (ppoll(wakers.data(), wakers.size(), &left, nullptr) != 0) return;
  }
}

void listenToSignals(Sleeper& sleeper) {
  listener = &sleeper;
  struct sigaction action {};
  action.sa_handler = onSignal;
  action.sa_flags = SA_RESTART;
  for (const int number : endingSignals()) sigaction(number, &action, nullptr);
}

bool isInterrupted() { return is_interrupted; }

}  // namespace baton
