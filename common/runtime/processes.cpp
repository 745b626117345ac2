#include "runtime/processes.hpp"

#include <unistd.h>

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <memory>
#include <utility>

#include "dds/process.hpp"

namespace baton {
namespace asio = boost::asio;

bool isRunning(const dds::Peer& peer) { return dds::isRunning(peer.pid, peer.process_began); }

void whenEnded(asio::io_context& executor, const dds::Peer& peer, std::function<void()> on_end) {
  const int descriptor = dds::openPidfd(peer.pid);
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
