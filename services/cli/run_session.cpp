#include "run_session.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>

#include "cell_client.hpp"
#include "dds/parting.hpp"
#include "runtime/log.hpp"
#include "runtime/paths.hpp"
#include "runtime/recording_parts.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario.hpp"
#include "runtime/signals.hpp"

namespace baton {
namespace fs = std::filesystem;
namespace {
std::atomic<int> caught_signals{0};
}  // namespace

/// Signals that ask for the end are counted while this lives.
class RunSession::SignalCounter {
 public:
  SignalCounter() {
    caught_signals = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { ++caught_signals; };
    for (const int number : endingSignals()) sigaction(number, &action, &old_[number]);
  }
  ~SignalCounter() {
    for (const auto& [number, old] : old_) sigaction(number, &old, nullptr);
  }
  SignalCounter(const SignalCounter&) = delete;
  SignalCounter& operator=(const SignalCounter&) = delete;

 private:
  std::map<int, struct sigaction> old_;
};

namespace {

/// Starts a program in a session of its own with its output in a log.
/// When `attached`, the kernel ends it with SIGTERM if this process dies.
pid_t launch(const fs::path& program, const std::vector<std::string>& arguments, const std::string& log_file,
             bool attached) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int log = open(log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0) throw UnavailableError("cannot write " + log_file + ": " + std::strerror(errno));
  const pid_t parent = getpid();
  // From before the fork, or one of ours could still take a signal that is meant for the program; until that is able to
  // end in order, since it inherits this over exec.
  const HeldSignals held;
  const pid_t pid = fork();
  if (pid == 0) {
    setsid();
    if (attached) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (getppid() != parent) _exit(127);  // it died before we asked to be told
    }
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  close(log);
  if (pid < 0) throw UnavailableError("cannot start " + program.string() + ": " + std::strerror(errno));
  return pid;
}

/// The latest words of a run.
class Onlooker {
 public:
  explicit Onlooker(const RunInfo& info)
      : participant_(operatorOf(info)),
        admission_(participant_, false, [](const std::string&) {}),  // the run itself tells
        sim_(participant_, dds::topics::kSimStatus, keepIn(latest_.sim), {},
             admission_.filter(dds::topics::kSimStatus)),
        recorder_(participant_, dds::topics::kRecorderStatus, keepIn(latest_.recorder), {},
                  admission_.filter(dds::topics::kRecorderStatus)) {}
  [[nodiscard]] RunProgress latest() {
    const std::lock_guard lock(mutex_);
    return latest_;
  }

 private:
  template <class Word>
  typename dds::Reader<Word>::Callback keepIn(std::optional<Word>& word) {
    return [this, &word](const Word& message, const dds::RawSample&) {
      const std::lock_guard lock(mutex_);
      word = message;
    };
  }

  std::mutex mutex_;
  RunProgress latest_;
  dds::Participant participant_;
  Admission admission_;
  dds::Reader<msg::SimStatus> sim_;
  dds::Reader<msg::RecorderStatus> recorder_;
};

}  // namespace

RunSession::~RunSession() = default;

RunSession::RunSession(const RunRequest& request, bool attached) : signals_(std::make_unique<SignalCounter>()) {
  info_.scenario = findScenario(request.scenario).string();
  const Scenario scenario = loadScenario(info_.scenario);  // a mistake in it is told here, not in a log
  for (const std::string& warning : scenario.warnings) sayWarning(warning);
  if (const std::optional<RunInfo> other = activeRun(request.domain, request.cell)) {
    throw UnavailableError("cell " + request.cell + " is in use by run " + other->run + " of " + other->scenario +
                           ": end it with `baton down --cell " + request.cell + " --domain " +
                           std::to_string(request.domain) + "`, or choose another --cell");
  }
  info_.cell = request.cell;
  info_.domain = request.domain;
  info_.run = newRunId();
  info_.transport = request.transport;
  const bool is_recorded = !request.no_recording && scenario.recording.enabled;
  if (!is_recorded && !request.out.empty()) {
    throw UsageError("--out " + request.out + ": the scenario or --no-recording says not to record");
  }
  if (request.record_later && scenario.recording.ring_steps > 0) {
    throw UsageError("--record-later: the scenario keeps a ring (recording.ring_s), which has no beginning");
  }
  if (!request.out.empty()) {
    std::vector<fs::path> reads = request.reads;
    reads.insert(reads.end(), {info_.scenario, scenario.robot_file});
    info_.recording =
        claimRecording("--out", request.out, scenario.recording.isSplit(), request.overwrite, reads).string();
  }
  info_.folder = runFolder(info_.run).string();  // nothing is refused from here on
  makeKeyWhenMissing(info_);
  if (is_recorded && request.out.empty()) info_.recording = info_.folder + "/" + scenario.name + ".mcap";

  std::vector<std::string> arguments{"--scenario",     info_.scenario,
                                     "--cell",         info_.cell,
                                     "--run",          info_.run,
                                     "--domain",       std::to_string(info_.domain),
                                     "--transport",    dds::toString(info_.transport),
                                     "--restarts",     std::to_string(request.restarts),
                                     "--clock-offset", std::to_string(info_.clock.offset())};
  if (!request.checkpoint.empty()) arguments.insert(arguments.end(), {"--checkpoint", request.checkpoint});
  for (std::string& argument : toArguments(request.scheduling)) arguments.push_back(std::move(argument));
  if (request.paused) arguments.emplace_back("--paused");
  if (request.is_open) arguments.emplace_back("--open");
  if (request.record_later) arguments.emplace_back("--record-later");
  if (info_.recording.empty()) {
    arguments.emplace_back("--no-recording");
  } else {
    arguments.insert(arguments.end(), {"--out", info_.recording});
  }
  info_.supervisor_pid = launch(siblingProgram("baton-supervisor"), arguments, logFile(), attached);
}

std::optional<ExitCode> RunSession::follow(const std::function<void(const RunProgress&)>& progress,
                                           const std::function<bool(const msg::SimStatus&)>& until) {
  const dds::Parting<Onlooker> onlooker(info_);
  int passed_on = 0;
  for (;;) {
    int how = 0;
    const pid_t ended = waitpid(info_.supervisor_pid, &how, WNOHANG);
    const RunProgress now = onlooker->latest();
    if (ended == info_.supervisor_pid) {
      progress(now);
      return WIFEXITED(how) ? static_cast<ExitCode>(WEXITSTATUS(how)) : ExitCode::kFailed;
    }
    if (passed_on < caught_signals) {
      passed_on = caught_signals;
      kill(info_.supervisor_pid, SIGTERM);
      kill(info_.supervisor_pid, SIGCONT);  // a stopped process would not receive it
    }
    progress(now);
    const bool is_to_end = passed_on > 0;
    if (!is_to_end && now.sim && until(*now.sim)) return std::nullopt;
    usleep(50'000);  // how often a person sees progress
  }
}

nlohmann::ordered_json readResult(const std::string& folder) {
  return nlohmann::ordered_json::parse(readFile(fs::path(folder) / "result.json"));
}

bool RunSession::wasInterrupted() const { return caught_signals > 0; }

nlohmann::ordered_json RunSession::result() const {
  try {
    return readResult(info_.folder);
  } catch (const std::exception& error) {
    const std::string last = lastLines(logFile(), 8);
    throw UnavailableError(
        std::string("the run ended without a result: ") + error.what() +
            (last.empty()
                 ? "; its log, " + logFile() +
                       ", is empty, as a full disk, too few files that a process may open (ulimit -n) and kill "
                       "-9 leave it"
                 : "; the end of " + logFile() + ":"),
        last);
  }
}

}  // namespace baton
