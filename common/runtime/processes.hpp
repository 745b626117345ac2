/// Processes of a run, watched by the others.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>

#include "dds/participant.hpp"

namespace baton {

/// Whether the process of a member of the run still runs, and is not another with the same number.
[[nodiscard]] bool isRunning(const dds::Peer& peer);

/// Calls `on_end` once, on the executor, when that process has ended: soon, if it has already.
void whenEnded(boost::asio::io_context& executor, const dds::Peer& peer, std::function<void()> on_end);

}  // namespace baton
