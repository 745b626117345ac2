#include "terminal.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <string_view>

namespace baton {
namespace {

termios as_found{};
termios as_taken{};
std::atomic<bool> is_taken{false};

/// Who changes the terminal from the background is stopped by the kernel.
void takeTerminal() noexcept {
  if (tcgetpgrp(STDIN_FILENO) != getpgrp()) return;
  is_taken = tcsetattr(STDIN_FILENO, TCSANOW, &as_taken) == 0;
}

/// Ctrl-Z: the shell gets its terminal as it was.
void suspend(int /*signal*/) {
  restoreTerminal();
  raise(SIGSTOP);
}

/// fg: who comes back, or comes from the background, takes the terminal; bg: not yet.
void resume(int /*signal*/) { takeTerminal(); }

}  // namespace

std::vector<Key> takeKeys(std::string& bytes) {
  std::vector<Key> keys;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::string_view rest = std::string_view(bytes).substr(at);
    if (rest.front() == '\033') {  // ESC [ or ESC O, parameters, a letter
      const bool is_sequence = rest.size() < 2 || rest[1] == '[' || rest[1] == 'O';
      const std::size_t last = is_sequence ? rest.find_first_not_of("0123456789;", 2) : 0;
      if (is_sequence && (rest.size() < 3 || last == std::string_view::npos)) break;
      if (rest[last] == 'C') keys.push_back(Key::kRight);
      if (rest[last] == 'D') keys.push_back(Key::kLeft);
      at += last + 1;
      continue;
    }
    switch (rest.front()) {
      case ' ': keys.push_back(Key::kSpace); break;
      case '+':
      case '=': keys.push_back(Key::kPlus); break;  // the same key, without shift
      case '-': keys.push_back(Key::kMinus); break;
      case 'q':
      case 'Q': keys.push_back(Key::kQuit); break;
      default: break;
    }
    ++at;
  }
  bytes.erase(0, at);
  return keys;
}

Terminal::Terminal() {
  if (tcgetattr(STDIN_FILENO, &as_found) != 0) return;  // no terminal
  as_taken = as_found;
  as_taken.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  as_taken.c_cc[VMIN] = 1;
  as_taken.c_cc[VTIME] = 0;
  as_taken.c_cc[VQUIT] = _POSIX_VDISABLE;  // Ctrl-\ would leave the terminal as it is
  std::signal(SIGTSTP, suspend);
  std::signal(SIGCONT, resume);
  takeTerminal();
}

Terminal::~Terminal() {
  std::signal(SIGCONT, SIG_DFL);
  restoreTerminal();
}

void restoreTerminal() noexcept {
  if (is_taken.exchange(false)) tcsetattr(STDIN_FILENO, TCSANOW, &as_found);
}

bool Terminal::hasKeys() const { return is_taken; }
int Terminal::descriptor() const { return is_taken ? STDIN_FILENO : -1; }

std::vector<Key> Terminal::keys() {
  pollfd input{.fd = descriptor(), .events = POLLIN, .revents = 0};
  while (is_taken && poll(&input, 1, 0) > 0) {
    std::array<char, 64> buffer{};
    const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
    if (count <= 0) {  // the terminal is gone
      is_taken = false;
      break;
    }
    bytes_.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return takeKeys(bytes_);
}

}  // namespace baton
