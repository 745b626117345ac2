#include "runtime/processes.hpp"

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <memory>
#include <utility>

namespace baton {
namespace asio = boost::asio;
// The system call itself, as older C libraries lack the function.
int openPidfd(int pid) { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

bool isRunning(const dds::Peer& peer) {
  pollfd end{.fd = openPidfd(peer.pid), .events = POLLIN, .revents = 0};
  if (end.fd < 0) return errno != ESRCH && errno != EINVAL;  // the system has no such descriptors: it may
  const bool has_ended = poll(&end, 1, 0) != 0;
  const bool is_another = peer.process_began != 0 && dds::processBegan(peer.pid) != peer.process_began;
  close(end.fd);
  return !has_ended && !is_another;
}

void whenEnded(asio::io_context& executor, const dds::Peer& peer, std::function<void()> on_end) {
  const int descriptor = openPidfd(peer.pid);
  if (!isRunning(peer)) {
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
