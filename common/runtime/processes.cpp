#include "runtime/processes.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <memory>
#include <string>
#include <utility>

namespace baton {
namespace asio = boost::asio;
namespace {

/// Whether it is another user's, who is not root. Where the system does not tell, it is not.
bool isSomebodyElses(int pid) {
  struct stat info {};
  if (stat(("/proc/" + std::to_string(pid)).c_str(), &info) != 0) return false;
  return info.st_uid != 0 && info.st_uid != geteuid();
}

}  // namespace

// The system call itself, as older C libraries lack the function.
int openPidfd(int pid) { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

bool isRunning(int pid) {
  pollfd end{.fd = openPidfd(pid), .events = POLLIN, .revents = 0};
  if (end.fd < 0) return errno != ESRCH && errno != EINVAL;  // the system has no such descriptors: it may
  const bool has_ended = poll(&end, 1, 0) != 0;
  close(end.fd);
  return !has_ended && !isSomebodyElses(pid);
}

void whenEnded(asio::io_context& executor, int pid, std::function<void()> on_end) {
  const int descriptor = openPidfd(pid);
  if (!isRunning(pid)) {
    if (descriptor >= 0) close(descriptor);
    asio::post(executor, std::move(on_end));
    return;
  }
  if (descriptor < 0) return;
  const auto end = std::make_shared<asio::posix::stream_descriptor>(executor, descriptor);
  end->async_wait(asio::posix::stream_descriptor::wait_read,
                  [end, on_end = std::move(on_end)](const boost::system::error_code& error) {
                    if (!error) on_end();
                  });
}

}  // namespace baton
