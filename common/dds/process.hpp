/// Other processes of this machine, looked at without being their parent.
#pragma once

#include <cstdint>
#include <optional>

namespace baton::dds {

/// A descriptor that becomes readable when the process ends; -1, with the reason in errno, when there is none.
[[nodiscard]] int openPidfd(int pid);

/// Ticks are the kernel's, sysconf(_SC_CLK_TCK) of them a second.
struct ProcessFacts {
  int parent = 0;
  std::uint64_t cpu_ticks = 0;  // spent by it, and by the kernel for it
  std::uint64_t began = 0;      // ticks after the machine: with the number it is that process and no other
};

/// What the system says of a process; nothing when there is none of that number, or it does not tell.
[[nodiscard]] std::optional<ProcessFacts> factsOf(int pid);

/// When it began, as ProcessFacts says; 0 when that is not known.
[[nodiscard]] std::uint64_t processBegan(int pid);

/// Whether it still runs and is not another with the same number. One that has ended and was not waited for does not
/// run. @param began  as processBegan() said; 0: whichever it is.
[[nodiscard]] bool isRunning(int pid, std::uint64_t began);

}  // namespace baton::dds
