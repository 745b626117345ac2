#include "measure.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "base/error.hpp"
#include "runtime/paths.hpp"

namespace baton::bench {

Scratch::Scratch(const std::filesystem::path& parent) {
  std::string pattern = (parent / "baton-bench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw UnavailableError("cannot make a folder like " + pattern);
  folder_ = pattern;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

Ended runProgram(const std::string& name, const std::vector<std::string>& arguments) {
  std::vector<std::string> all{siblingProgram(name).string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv(all.size() + 1, nullptr);
  std::transform(all.begin(), all.end(), argv.begin(), [](std::string& argument) { return argument.data(); });
  const Stopwatch watch;
  const pid_t pid = ::fork();
  if (pid < 0) throw UnavailableError("cannot start " + all.front());
  if (pid == 0) {
    const int nowhere = ::open("/dev/null", O_RDWR);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int how = 0;
  rusage usage{};
  while (::wait4(pid, &how, 0, &usage) < 0 && errno == EINTR) continue;
  return {.exit_code = WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how),
          .seconds = watch.seconds(),
          .peak_MB = static_cast<double>(usage.ru_maxrss) * 1e-3};
}

double residentMegabytes() {
  std::uint64_t whole = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> whole >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

}  // namespace baton::bench
