#include "become.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#include "runtime/paths.hpp"

namespace baton {

void become(const std::string& program, std::vector<std::string> arguments) {
  const std::string path = siblingProgram(program);
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(path.c_str(), argv.data());
  throw UnavailableError("cannot start " + path + ": " + std::strerror(errno));
}

}  // namespace baton
