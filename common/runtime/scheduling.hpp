/// How the kernel is to treat the processes of the loop: in batches while they wait for each other and not for the
/// clock; first-in-first-out real-time scheduling and fixed cores, where the deployment asks for them and the system
/// allows it.
#pragma once

#include <string>
#include <vector>

namespace baton {

struct Scheduling {
  int fifo_priority = 0;  // SCHED_FIFO, 1 to 99; 0: as the system does by default
  std::string cpus;       // "0" or "0,2": the cores to stay on; empty: any
};

/// Reads "0,2". Throws UsageError when it is not a list of cores of this machine.
[[nodiscard]] std::vector<int> parseCpus(const std::string& text);

/// The arguments that addScheduling() (runtime/command_line.hpp) reads.
[[nodiscard]] std::vector<std::string> toArguments(const Scheduling& scheduling);

/// Asks the kernel, for this thread and all that it starts. Returns one sentence for each wish that was refused: a run
/// is possible without. Throws UsageError for a wish that cannot be meant.
/// @param in_batches  without a priority: who is woken does not interrupt who runs (SCHED_BATCH). A process that sends
///                    a sample to three others sends it to all three before one of them takes the core.
[[nodiscard]] std::vector<std::string> applyScheduling(const Scheduling& wanted, bool in_batches);

}  // namespace baton
