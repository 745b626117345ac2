#include "runtime/scheduling.hpp"

#include <sched.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <tuple>

#include "base/error.hpp"
#include "base/number.hpp"

namespace baton {

std::vector<int> parseCpus(const std::string& text) {
  const int count = static_cast<int>(sysconf(_SC_NPROCESSORS_CONF));
  std::vector<int> cpus;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    const auto cpu = numberIn<int>(part);
    if (!cpu || *cpu < 0 || *cpu >= count) {
      throw UsageError("cores: expected numbers from 0 to " + std::to_string(count - 1) + " with commas, found " +
                       text);
    }
    cpus.push_back(*cpu);
  }
  if (cpus.empty()) throw UsageError("cores: expected at least one");
  return cpus;
}

std::vector<std::string> toArguments(const Scheduling& scheduling) {
  std::vector<std::string> arguments;
  if (scheduling.fifo_priority > 0) {
    arguments.insert(arguments.end(), {"--fifo", std::to_string(scheduling.fifo_priority)});
  }
  if (!scheduling.cpus.empty()) arguments.insert(arguments.end(), {"--cpus", scheduling.cpus});
  return arguments;
}

std::vector<std::string> applyScheduling(const Scheduling& wanted, bool in_batches) {
  std::vector<std::string> refusals;
  if (in_batches && wanted.fifo_priority == 0) {
    const sched_param none{};
    std::ignore = sched_setscheduler(0, SCHED_BATCH, &none);  // needs no right; where it is not known, nothing is lost
  }
  if (!wanted.cpus.empty()) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int cpu : parseCpus(wanted.cpus)) CPU_SET(static_cast<unsigned>(cpu), &set);
    if (sched_setaffinity(0, sizeof set, &set) != 0) {
      refusals.push_back("the system does not let this process stay on cores " + wanted.cpus + ": " +
                         std::strerror(errno));
    }
  }
  if (wanted.fifo_priority > 0) {
    const sched_param parameters{.sched_priority = wanted.fifo_priority};
    if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
      refusals.push_back("the system refuses SCHED_FIFO priority " + std::to_string(wanted.fifo_priority) + " (" +
                         std::strerror(errno) +
                         "): it takes root, CAP_SYS_NICE or an rtprio limit (ulimit -r); going on without");
    }
  }
  return refusals;
}

}  // namespace baton
