#include "gnuplot.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <fstream>
#include <utility>

#include "base/error.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

/// Lets gnuplot work on `argument` in `folder`.
void runGnuplot(const fs::path& folder, const std::string& argument) {
  const pid_t pid = fork();
  if (pid == 0) {
    if (chdir(folder.c_str()) != 0) _exit(126);
    if (argument == "--version" && freopen("/dev/null", "w", stdout) == nullptr) _exit(126);
    execlp("gnuplot", "gnuplot", argument.c_str(), nullptr);
    _exit(127);
  }
  int how = 0;
  if (pid < 0 || waitpid(pid, &how, 0) != pid) throw UnavailableError("cannot start gnuplot");
  if (WIFEXITED(how) && WEXITSTATUS(how) == 127) {
    throw UnavailableError("gnuplot is missing: install it (Debian: gnuplot-nox)");
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
  std::ofstream script(stem.string() + ".gp", std::ios::binary);
  script << "# Drawn by baton; run gnuplot on this file to draw it again.\nset encoding utf8\n" << data;
  const std::string name = stem.filename().string();
  for (const auto& [terminal, extension] :
       {std::pair{"svg enhanced background 'white' font 'Helvetica,12'", "svg"},
        std::pair{"pngcairo enhanced background 'white' font 'Helvetica,11'", "png"}}) {
    script << fmt::format("set terminal {} size {},{}\nset output {}\n", terminal, size.width, size.height,
                          quoted(name + "." + extension))
           << commands << "unset output\nreset\n";
  }
  script.close();
  if (!script) throw UnavailableError("cannot write " + stem.string() + ".gp");
  runGnuplot(stem.parent_path(), name + ".gp");
}

void expectGnuplot() { runGnuplot(fs::temp_directory_path(), "--version"); }

}  // namespace baton
