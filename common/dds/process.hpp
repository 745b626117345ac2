/// Other processes of this machine, looked at without being their parent.
#pragma once

#include <cstdint>

namespace baton::dds {

/// A descriptor that becomes readable when the process ends; -1, with the reason in errno, when there is none.
[[nodiscard]] int openPidfd(int pid);

/// When a process began, in ticks of the kernel since it started: with the number it is that process and no other. 0
/// when there is none of that number, or the system does not tell.
[[nodiscard]] std::uint64_t processBegan(int pid);

/// Whether it still runs and is not another with the same number. One that has ended and was not waited for does not
/// run. @param began  as processBegan() said; 0: whichever it is.
[[nodiscard]] bool isRunning(int pid, std::uint64_t began);

}  // namespace baton::dds
