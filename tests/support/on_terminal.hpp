/// The replayer on a terminal of its own, as a person starts it.
#pragma once

#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "support/processes.hpp"

namespace baton::test {

class OnTerminal {
 public:
  explicit OnTerminal(const Bench& bench, std::vector<std::string> arguments) {
    const std::string program = (programFolder() / "baton-replayer").string();
    arguments.insert(arguments.begin(), program);
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const std::string home = bench.folder().string();
    pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) {
      setenv("BATON_HOME", home.c_str(), 1);
      execv(program.c_str(), argv.data());
      _exit(127);
    }
  }
  ~OnTerminal() {
    if (pid_ > 0) kill(pid_, SIGKILL);
    close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  void strike(const std::string& keys) const {
    ASSERT_EQ(write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  void signal(int number) const { ASSERT_EQ(kill(pid_, number), 0); }
  /// Whether lines are edited and echoed, as a shell wants them.
  [[nodiscard]] bool isAsFound() const {
    termios attributes{};
    tcgetattr(terminal_, &attributes);
    return (attributes.c_lflag & ICANON) != 0 && (attributes.c_lflag & ECHO) != 0;
  }
  [[nodiscard]] bool isStopped() const {
    int how = 0;
    return waitpid(pid_, &how, WUNTRACED | WNOHANG) == pid_ && WIFSTOPPED(how);
  }
  int exitCode() {
    int how = 0;
    EXPECT_TRUE(eventually([&] { return waitpid(pid_, &how, WNOHANG) == pid_; }));
    pid_ = 0;
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
  }

 private:
  int terminal_ = -1;
  pid_t pid_ = 0;
};

}  // namespace baton::test
