/// Other processes of this machine, watched without being their parent.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>

namespace baton {

/// A descriptor that becomes readable when the process ends; -1, with the reason in errno, when there is none.
[[nodiscard]] int openPidfd(int pid);

/// Whether a process runs that may have what is this user's alone: this user's or root's, so that a number which the
/// kernel has given to somebody else's process in the meantime is not taken for it.
[[nodiscard]] bool isRunning(int pid);

/// Calls `on_end` once, on the executor, when the process has ended: soon, if it has already.
void whenEnded(boost::asio::io_context& executor, int pid, std::function<void()> on_end);

}  // namespace baton
