#include "gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <utility>

#include "base/error.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

/// Lets gnuplot work on `argument` in `folder`.
void runGnuplot(const fs::path& folder, const std::string& argument) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  if (argument == "--version") posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::string program = "gnuplot", word = argument;
  char* const arguments[] = {program.data(), word.data(), nullptr};
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, program.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT && fs::is_directory(folder)) {
    throw UnavailableError("gnuplot is missing: install it (Debian: gnuplot-nox)");
  }
  if (error != 0) throw UnavailableError("cannot start gnuplot in " + folder.string() + ": " + std::strerror(error));
  int how = -1;
  while (waitpid(pid, &how, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(how) || WEXITSTATUS(how) != 0) {
    throw UnavailableError("gnuplot failed on " + (folder / argument).string() + ": run it by hand to see why");
  }
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += c;
    result += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
  }
  return result + "'";
}

void drawScript(const fs::path& stem, const PictureSize& size, const std::string& data, const std::string& commands) {
  std::ostringstream script;
  script << "# Drawn by baton; run gnuplot on this file to draw it again.\nset encoding utf8\n" << data;
  const std::string name = stem.filename().string();
  for (const auto& [terminal, extension] :
       {std::pair{"svg enhanced background 'white' font 'Helvetica,12'", "svg"},
        std::pair{"pngcairo enhanced background 'white' font 'Helvetica,11'", "png"}}) {
    script << fmt::format("set terminal {} size {},{}\nset output {}\n", terminal, size.width, size.height,
                          quoted(name + "." + extension))
           << commands << "unset output\nreset\n";
  }
  writeFile(stem.string() + ".gp", script.str());
  runGnuplot(stem.parent_path(), name + ".gp");
}

void expectGnuplot() { runGnuplot(fs::temp_directory_path(), "--version"); }

}  // namespace baton
