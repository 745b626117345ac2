/// Other processes of this machine, watched without being their parent.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>

#include "dds/participant.hpp"

namespace baton {

/// A descriptor that becomes readable when the process ends; -1, with the reason in errno, when there is none.
[[nodiscard]] int openPidfd(int pid);

/// Whether the process of a member of the run still runs, and is not another with the same number.
[[nodiscard]] bool isRunning(const dds::Peer& peer);

/// Calls `on_end` once, on the executor, when that process has ended: soon, if it has already.
void whenEnded(boost::asio::io_context& executor, const dds::Peer& peer, std::function<void()> on_end);

}  // namespace baton
