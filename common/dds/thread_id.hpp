#pragma once

namespace baton::dds {

/// From here on, a thread of this process that asks the kernel who it is more than once is answered by the process
/// itself (why: thread_id.cpp).
void rememberThreadIds() noexcept;

}  // namespace baton::dds
