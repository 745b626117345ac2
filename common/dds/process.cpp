#include "dds/process.hpp"

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

namespace baton::dds {

// The system call itself, as older C libraries lack the function.
int openPidfd(int pid) { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

std::uint64_t processBegan(int pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  const std::string text((std::istreambuf_iterator<char>(stat)), {});
  if (text.empty()) return 0;
  // "pid (name) state ...": the name may have blanks and brackets. The time is the twentieth word after it.
  std::istringstream words(text.substr(std::min(text.rfind(')'), text.size() - 1) + 1));
  std::string skipped;
  for (int i = 0; i < 19; ++i) words >> skipped;
  std::uint64_t ticks = 0;
  return words >> ticks ? ticks : 0;
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
