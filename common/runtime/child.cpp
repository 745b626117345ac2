#include "runtime/child.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/process/args.hpp>
#include <boost/process/child.hpp>
#include <boost/process/error.hpp>
#include <boost/process/exe.hpp>
#include <boost/process/extend.hpp>
#include <csignal>
#include <cstring>
#include <fstream>

#include "base/error.hpp"
#include "dds/process.hpp"

namespace baton {
namespace asio = boost::asio;
namespace process = boost::process;
namespace {

/// Runs in the child between fork and exec.
struct ChildSetup : process::extend::handler {
  int log;
  pid_t parent;
  ChildSetup(int log_descriptor, pid_t parent_id) : log(log_descriptor), parent(parent_id) {}

  template <class Executor>
  // NOLINTNEXTLINE(readability-identifier-naming): the name Boost looks for
  void on_exec_setup(Executor& executor) const {
    setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) raise(SIGTERM);  // it died before the line above
    const int nothing = open("/dev/null", O_RDONLY);
    if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(log, STDOUT_FILENO) < 0 ||
        dup2(log, STDERR_FILENO) < 0) {
      executor.set_error(process::extend::get_last_error(), "standard streams");
    }
    // What else is open here, DDS's sockets among it, is not the child's.
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  }
};

}  // namespace

/// Boost.Process starts it. Its own way to wait for the end reaps children of the entire program on SIGCHLD, and Boost
/// 1.74 has no other, so the end is waited for on a pidfd here.
struct Child::Process {
  process::child handle;
  asio::posix::stream_descriptor end;
};

Child::Child(asio::io_context& executor, Command command, std::function<void(Child&, const End&)> on_end)
    : command_(std::move(command)) {
  const int log = open(command_.log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0) {
    throw UnavailableError("cannot write the log " + command_.log_file.string() + ": " + std::strerror(errno));
  }
  std::error_code error;
  process::child handle(process::exe = command_.program.string(), process::args = command_.arguments,
                        ChildSetup(log, getpid()), error);
  close(log);
  if (error) throw UnavailableError("cannot start " + command_.program.string() + ": " + error.message());
  pid_ = handle.id();
  const int pidfd = dds::openPidfd(pid_);
  if (pidfd < 0) {
    const std::string reason = std::strerror(errno);
    handle.terminate();
    throw UnavailableError("cannot watch " + command_.program.string() + ": pidfd_open: " + reason);
  }
  process_ = std::make_unique<Process>(Process{std::move(handle), asio::posix::stream_descriptor(executor, pidfd)});
  is_running_ = true;
  process_->end.async_wait(asio::posix::stream_descriptor::wait_read, [this, on_end = std::move(on_end)](
                                                                          const boost::system::error_code& wait_error) {
    if (wait_error == asio::error::operation_aborted) return;  // the child is not wanted any more
    is_running_ = false;
    process_->end.close();
    int status = 0;
    if (wait_error || waitpid(pid_, &status, 0) != pid_) return on_end(*this, {false, 127});
    process_->handle.detach();
    on_end(*this, WIFSIGNALED(status) ? End{true, WTERMSIG(status)} : End{false, WEXITSTATUS(status)});
  });
}

Child::~Child() = default;  // Boost's handle kills and reaps a process that is still running

void Child::signal(int number) const {
  if (!is_running_) return;
  kill(pid_, number);
  if (number == SIGTERM) kill(pid_, SIGCONT);  // a stopped process could not end in order
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
