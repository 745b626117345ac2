#include "support/processes.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "support/own_domain.hpp"

namespace baton::test {
namespace fs = std::filesystem;
namespace {

// With nohup, and after a shell's &, programs ignore some signals, and so would those that the tests start.
[[maybe_unused]] const bool kSignalsAsOnATerminal = [] {
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) signal(number, SIG_DFL);
  return true;
}();

/// More than any program of a test takes, and less than CTest waits for a test.
constexpr std::chrono::minutes kLongestProgram{7};

std::string contentsOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

pid_t launch(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& home,
             const fs::path& out, const fs::path& err) {
  std::vector<std::string> all{program.string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(all.size() + 1);
  for (std::string& argument : all) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // it does not outlive a test that is killed
    setenv("BATON_HOME", home.c_str(), 1);
    const int out_file = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int err_file = out == err ? out_file : open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(out_file, STDOUT_FILENO);
    dup2(err_file, STDERR_FILENO);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  if (pid < 0) throw std::runtime_error("fork failed");
  return pid;
}

/// Returns the exit code. A program that hangs fails its test, with its last words, rather than CTest's patience.
int waitFor(pid_t pid, const std::vector<fs::path>& outputs) {
  int how = 0;
  if (!eventually([&] { return waitpid(pid, &how, WNOHANG) == pid; }, kLongestProgram)) {
    kill(pid, SIGKILL);
    waitpid(pid, &how, 0);
    std::string words;
    for (const fs::path& output : outputs) words += "\n" + output.string() + ":\n" + contentsOf(output);
    throw std::runtime_error("process " + std::to_string(pid) + " does not end" + words);
  }
  return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

}  // namespace

fs::path programFolder() { return BATON_TEST_PROGRAMS; }

void standIn(const Bench& bench, const std::string& program, const std::string& script) {
  fs::permissions(bench.write("programs/" + program, "#!/bin/sh\n" + script + "\n"), fs::perms::owner_all);
}

fs::path programsBut(const Bench& bench, const std::string& program, const std::string& script) {
  fs::path folder = bench.folder() / "programs";
  fs::create_directory(folder);
  for (const auto& entry : fs::directory_iterator(programFolder())) {
    const std::string name = entry.path().filename();
    const bool is_wanted = name.starts_with("baton") && !name.starts_with("baton-bench") && name != program;
    if (is_wanted) fs::copy_file(entry.path(), folder / name);
  }
  standIn(bench, program, script);
  return folder;
}

Finished runProgram(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& home) {
  static std::atomic<int> count{0};  // tests call this from several threads
  const std::string stem = "call" + std::to_string(++count);
  const fs::path out = home / (stem + ".out");
  const fs::path err = home / (stem + ".err");
  const int exit_code = waitFor(launch(program, arguments, home, out, err), {out, err});
  return {exit_code, contentsOf(out), contentsOf(err)};
}

Bench::Bench() : domain_(ownDomain()) {
  std::string pattern = (fs::temp_directory_path() / "baton-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = pattern;
}

Bench::~Bench() {
  for (const auto& [pid, log] : started_) {
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
  // What a failed test may have left running has this folder on its command line.
  for (const int pid : processesWith(folder_.string())) kill(pid, SIGKILL);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Finished Bench::baton(std::vector<std::string> arguments) const {
  static const std::vector<std::string> kWithoutDomain{"bag",    "metrics", "model",    "shadow",
                                                       "whatif", "--help",  "--version"};
  const bool takes_domain =
      std::find(kWithoutDomain.begin(), kWithoutDomain.end(), arguments.front()) == kWithoutDomain.end();
  if (takes_domain) arguments.insert(arguments.end(), {"--domain", std::to_string(domain_)});
  return runProgram(programFolder() / "baton", arguments, folder_);
}

nlohmann::json Bench::batonJson(std::vector<std::string> arguments) const {
  const Finished finished = baton(std::move(arguments));
  try {
    return nlohmann::json::parse(finished.out);
  } catch (const std::exception& error) {
    throw std::runtime_error("no JSON from baton (" + std::string(error.what()) + "), exit code " +
                             std::to_string(finished.exit_code) + "\n" + finished.out + finished.err);
  }
}

int Bench::start(const std::string& program, const std::vector<std::string>& arguments, const std::string& log) {
  const fs::path file = folder_ / log;
  const int pid = launch(programFolder() / program, arguments, folder_, file, file);
  started_[pid] = file;
  return pid;
}

int Bench::wait(int pid) {
  const fs::path log = started_.at(pid);
  started_.erase(pid);
  return waitFor(pid, {log});
}

std::string Bench::write(const std::string& name, const std::string& text) const {
  const fs::path file = folder_ / name;
  std::ofstream(file, std::ios::binary) << text;
  return file.string();
}

bool eventually(const std::function<bool()>& condition, std::chrono::minutes patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    usleep(10'000);
  }
  return true;
}

std::vector<int> processesWith(const std::string& text) {
  std::vector<int> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (!std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; })) continue;
    std::string command = contentsOf(entry.path() / "cmdline");
    std::replace(command.begin(), command.end(), '\0', ' ');
    if (std::stoi(name) != getpid() && command.find(text) != std::string::npos) found.push_back(std::stoi(name));
  }
  return found;
}

}  // namespace baton::test
