#include "dds/process.hpp"

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>

namespace baton::dds {

// The system call itself, as older C libraries lack the function.
int openPidfd(int pid) { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

std::optional<ProcessFacts> factsOf(int pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  const std::string text((std::istreambuf_iterator<char>(stat)), {});
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  // "pid (name) state parent ...", as in proc(5): the name may have blanks and brackets. From the fourth word, the
  // parent, to the twenty-second, the time, all are numbers.
  std::istringstream words(text.substr(name_end + 1));
  std::string state;
  std::array<long long, 19> numbers{};
  words >> state;
  for (long long& number : numbers) words >> number;
  if (!words) return std::nullopt;
  return ProcessFacts{.parent = static_cast<int>(numbers[0]),
                      .cpu_ticks = static_cast<std::uint64_t>(numbers[10] + numbers[11]),
                      .began = static_cast<std::uint64_t>(numbers[18])};
}

std::uint64_t processBegan(int pid) {
  const std::optional<ProcessFacts> facts = factsOf(pid);
  return facts ? facts->began : 0;
}

bool isRunning(int pid, std::uint64_t began) {
  pollfd end{.fd = openPidfd(pid), .events = POLLIN, .revents = 0};
  if (end.fd < 0) return errno != ESRCH && errno != EINVAL;  // the system has no such descriptors: it may
  const bool has_ended = poll(&end, 1, 0) != 0;
  const std::uint64_t now_began = processBegan(pid);
  const bool is_another = began != 0 && now_began != 0 && now_began != began;
  close(end.fd);
  return !has_ended && !is_another;
}

}  // namespace baton::dds
