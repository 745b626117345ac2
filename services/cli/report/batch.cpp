#include "batch.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <deque>
#include <memory>

#include "dds/topics.hpp"
#include "recording.hpp"
#include "runtime/build_id.hpp"
#include "runtime/child.hpp"
#include "runtime/log.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/scenario.hpp"
#include "runtime/signals.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

/// Whether `file` records this very experiment, completely, made by this very build.
bool isRecordingOf(const fs::path& file, const Scenario& scenario, const std::string& build) {
  if (!fs::is_regular_file(file)) return false;
  try {
    const mcap::Reader reader(file);
    std::uint64_t states = 0;  // a run that was stopped before its end can be complete as a recording
    for (const auto& [id, channel] : reader.channels()) {
      const auto count = reader.statistics().channel_message_counts.find(id);
      const bool has_states = channel.topic == dds::topics::kPlantState.name;
      if (has_states && count != reader.statistics().channel_message_counts.end()) states += count->second;
    }
    return states == scenario.end_step + 1 && isCertified(reader) &&
           metadataValue(reader, "baton.run", "build_id") == build &&
           attachmentText(reader, "scenario.yaml") == scenario.text &&
           attachmentText(reader, "robot.yaml") == scenario.robot_text;
  } catch (const std::exception&) {
    return false;  // not a recording that anybody can use
  }
}

class Batch {
 public:
  Batch(const std::vector<fs::path>& scenarios, const BatchOptions& options)
      : options_(options), signals_(executor_), timer_(executor_) {
    for (const int number : endingSignals()) signals_.add(number);
    makeFolder(options.folder);
    const std::string build = buildId();
    for (const fs::path& file : scenarios) {
      const Scenario scenario = loadScenario(file.string());
      Job job{.run = {.scenario = file.stem().string(),
                      .file = file,
                      .recording = options.folder / (file.stem().string() + ".mcap"),
                      .failure = {}},
              .steps = static_cast<double>(scenario.end_step),
              .child = nullptr};
      if (scenario.end_step == 0) {
        throw UsageError(file.string() + ": expected a scenario with an end (duration_s), found none");
      }
      job.run.was_reused = !options.fresh && isRecordingOf(job.run.recording, scenario, build);
      jobs_.push_back(std::move(job));
      if (!jobs_.back().run.was_reused) waiting_.push_back(jobs_.size() - 1);
    }
    // The longest first: the last to end is then a short one.
    std::stable_sort(waiting_.begin(), waiting_.end(),
                     [this](std::size_t a, std::size_t b) { return jobs_[a].steps > jobs_[b].steps; });
    for (const std::size_t index : waiting_) total_ += jobs_[index].steps;
  }

  std::vector<BatchRun> run() {
    awaitSignal();
    for (int i = 0; i < options_.jobs; ++i) startNext();
    if (running_ > 0) {
      tick();
      executor_.run();
    }
    line_.clear();
    if (was_interrupted_) throw Error(ExitCode::kInterrupted, "interrupted; what is recorded is used the next time");
    std::vector<BatchRun> runs;
    runs.reserve(jobs_.size());
    for (Job& job : jobs_) runs.push_back(std::move(job.run));
    return runs;
  }

 private:
  struct Job {
    BatchRun run;
    double steps = 0.0;
    std::unique_ptr<Child> child;
    Clock::time_point started{};
    bool is_running = false;
  };

  void startNext() {
    if (waiting_.empty() || was_interrupted_) return;
    const std::size_t index = waiting_.front();
    waiting_.pop_front();
    Job& job = jobs_[index];
    const fs::path log = options_.folder / (job.run.scenario + ".log");
    fs::remove(log);
    job.started = Clock::now();
    job.is_running = true;
    ++running_;
    job.child = std::make_unique<Child>(
        executor_,
        Child::Command{
            .name = job.run.scenario,
            .program = siblingProgram("baton"),
            .arguments = {"run", job.run.file.string(), "--out", job.run.recording.string(), "--overwrite", "--json",
                          "--transport", dds::toString(options_.transport), "--domain", std::to_string(options_.domain),
                          "--cell", fmt::format("figures-{}-{}", getpid(), index)},
            .log_file = log},
        [this, index](Child&, const Child::End& end) { ended(index, end); });
  }

  void ended(std::size_t index, const Child::End& end) {
    Job& job = jobs_[index];
    job.is_running = false;
    --running_;
    done_ += job.steps;
    const fs::path log = options_.folder / (job.run.scenario + ".log");
    if (end.by_signal || end.value != 0) {
      job.run.failure = end.text() + "\n" + lastLines(log, 8);
      std::error_code none_there;  // kept to look into, and out of the way of the next attempt
      fs::rename(job.run.recording, options_.folder / (job.run.scenario + ".failed.mcap"), none_there);
    } else {
      fs::remove(log);
    }
    startNext();
    if (running_ == 0) {
      timer_.cancel();
      signals_.cancel();
    }
  }

  /// The first Ctrl-C ends the runs in order, the second at once.
  void awaitSignal() {
    signals_.async_wait([this](const boost::system::error_code& error, int) {
      if (error || running_ == 0) return;  // what is on its way already cannot be cancelled
      for (const Job& job : jobs_) {
        if (job.is_running) job.child->signal(was_interrupted_ ? SIGKILL : SIGTERM);
      }
      was_interrupted_ = true;
      awaitSignal();
    });
  }

  void tick() {
    timer_.expires_after(std::chrono::milliseconds(200));
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error || running_ == 0) return;
      line_.show(progress());
      tick();
    });
  }

  /// Runs under way count by the pace so far: how far they are only their own processes know.
  [[nodiscard]] std::string progress() const {
    const double elapsed_s = secondsSince(begin_);
    double steps = done_;
    std::string names;
    for (const Job& job : jobs_) {
      if (!job.is_running) continue;
      names += (names.empty() ? "" : ", ") + job.run.scenario;
      const double pace = done_ > 0.0 ? done_ / elapsed_s : kFirstPace;
      steps += std::min(0.95 * job.steps, secondsSince(job.started) * pace / std::max(1, running_));
    }
    const double part = total_ > 0.0 ? steps / total_ : 1.0;
    return fmt::format("{} {:3.0f} %  {:.0f} s left  {}", progressBar(part), 100.0 * part,
                       part > 0.0 ? elapsed_s * (1.0 - part) / part : 0.0, names);
  }

  static constexpr double kFirstPace = 3000.0;  // steps/s, until a run has ended

  BatchOptions options_;
  boost::asio::io_context executor_{1};
  std::vector<Job> jobs_;  // their children live on the executor
  std::deque<std::size_t> waiting_;
  boost::asio::signal_set signals_;
  boost::asio::steady_timer timer_;
  Clock::time_point begin_ = Clock::now();
  int running_ = 0;
  double done_ = 0.0;
  double total_ = 0.0;
  bool was_interrupted_ = false;
  ProgressLine line_;
};

}  // namespace

std::vector<BatchRun> runBatch(const std::vector<fs::path>& scenarios, const BatchOptions& options) {
  return Batch(scenarios, options).run();
}

}  // namespace baton
