#include "runtime/child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/process/v2/process.hpp>
#include <csignal>
#include <cstring>
#include <fstream>

#include "base/error.hpp"

namespace baton {
namespace process = boost::process::v2;
namespace {

/// Runs in the child between fork and exec.
struct ChildSetup {
  int log;
  pid_t parent;

  template <class Launcher>
  // NOLINTNEXTLINE(readability-identifier-naming): the name Boost looks for
  boost::system::error_code on_exec_setup(Launcher&, const process::filesystem::path&, const char* const*) {
    setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) raise(SIGTERM);  // it died before we asked to be told
    const int nothing = open("/dev/null", O_RDONLY);
    if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(log, STDOUT_FILENO) < 0 ||
        dup2(log, STDERR_FILENO) < 0) {
      return {errno, boost::system::system_category()};
    }
    return {};
  }
};

}  // namespace

struct Child::Process {
  process::process handle;
};

Child::Child(boost::asio::io_context& executor, Command command, std::function<void(Child&, const End&)> on_end)
    : command_(std::move(command)) {
  const int log = open(command_.log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0) {
    throw UnavailableError("cannot write the log " + command_.log_file.string() + ": " + std::strerror(errno));
  }
  boost::system::error_code error;
  process::process handle = process::default_process_launcher()(executor, error, command_.program.string(),
                                                                command_.arguments, ChildSetup{log, getpid()});
  close(log);
  if (error) throw UnavailableError("cannot start " + command_.program.string() + ": " + error.message());
  process_ = std::make_unique<Process>(Process{std::move(handle)});
  pid_ = process_->handle.id();
  is_running_ = true;
  process_->handle.async_wait([this, on_end = std::move(on_end)](const boost::system::error_code& wait_error, int) {
    is_running_ = false;
    if (wait_error) return on_end(*this, {false, 127});  // it cannot be watched any more
    const int status = process_->handle.native_exit_code();
    on_end(*this, WIFSIGNALED(status) ? End{true, WTERMSIG(status)} : End{false, WEXITSTATUS(status)});
  });
}

Child::~Child() {
  if (is_running_) kill(pid_, SIGKILL);
}

void Child::signal(int number) const {
  if (is_running_) kill(pid_, number);
}

std::string Child::End::text() const {
  if (!by_signal) return "exit code " + std::to_string(value);
  return "signal " + std::to_string(value) + " (" + strsignal(value) + ")";
}

long Child::residentKilobytes() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  }
  return 0;
}

}  // namespace baton
