/// One child process: its own process group (Ctrl-C reaches the supervisor alone), its output in a log file, ended by
/// the kernel if the supervisor dies, watched by pidfd.
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace baton {

class Child {
 public:
  struct Command {
    std::string name;  // the service's
    std::filesystem::path program;
    std::vector<std::string> arguments;
    std::filesystem::path log_file;  // appended to
  };
  /// How a process ended, "exit code 3" or "signal 9 (Killed)".
  struct End {
    bool by_signal = false;
    int value = 0;
    [[nodiscard]] std::string text() const;
  };

  /// Starts the program. `on_end` runs on the executor, once. Throws UnavailableError when it cannot be started.
  Child(boost::asio::io_context& executor, Command command, std::function<void(Child&, const End&)> on_end);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void signal(int number) const;
  [[nodiscard]] bool isRunning() const { return is_running_; }
  [[nodiscard]] int pid() const { return pid_; }
  [[nodiscard]] const Command& command() const { return command_; }
  [[nodiscard]] const std::string& name() const { return command_.name; }
  /// Resident memory [kB], 0 when the process is gone.
  [[nodiscard]] long residentKilobytes() const;

 private:
  struct Process;
  Command command_;
  std::unique_ptr<Process> process_;
  int pid_ = 0;
  bool is_running_ = false;
};

}  // namespace baton
