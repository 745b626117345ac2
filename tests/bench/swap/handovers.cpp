#include "handovers.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <thread>

#include "base/error.hpp"
#include "dds/typed.hpp"
#include "runtime/paths.hpp"
#include "runtime/scenario.hpp"
#include "runtime/scenario_edit.hpp"
#include "runtime/service_options.hpp"

namespace baton::bench {
namespace {

constexpr auto kPatience = std::chrono::seconds(30);
constexpr std::size_t kRemembered = 4096;             // states
constexpr std::uint64_t kContactWithin_steps = 6000;  // the arm moves into the wall and comes to rest there

/// `lab`, in the mode of the case.
std::string scenarioText(const SwapCase& one) {
  std::vector<ScenarioSetting> settings{{"name", "bench"}, {"robot", "rpp"}};
  if (one.is_realtime) {
    settings.insert(settings.end(), {{"mode", "realtime"}, {"step_s", "0.001"}, {"substeps", "8"}});
  }
  return editScenario(readFile(findScenario("lab")), settings);
}

/// Somebody who watches the run and speaks to its plant.
class Operator {
 public:
  Operator(int domain, const std::string& cell)
      : participant_({.domain = domain, .partition = cell + "/*", .cell = cell, .run = "", .service = "bench"}),
        states_(participant_, dds::topics::kPlantState,
                [this](const msg::PlantState& state, const dds::RawSample& sample) { onState(state, sample); }),
        outcomes_(participant_, dds::topics::kSwapOutcome,
                  [this](const msg::SwapOutcome& outcome, const dds::RawSample&) { onOutcome(outcome); }),
        swaps_(participant_, dds::topics::kSwapRequest),
        requests_(participant_, dds::topics::kSimRequest) {}

  /// Whether the plant can be spoken to, and its answers come.
  [[nodiscard]] bool isConnected() {
    const std::lock_guard lock(mutex_);
    return plant_ && swaps_.raw().matched().contains(*plant_) && requests_.raw().matched().contains(*plant_) &&
           outcomes_.raw().matched().contains(*plant_);
  }
  [[nodiscard]] std::uint64_t step() {
    const std::lock_guard lock(mutex_);
    return step_;
  }
  [[nodiscard]] std::string holder() {
    const std::lock_guard lock(mutex_);
    return holder_;
  }
  /// How often somebody took over whom nobody had asked.
  [[nodiscard]] std::uint64_t failovers() {
    const std::lock_guard lock(mutex_);
    return failovers_;
  }
  /// Waits until that step has opened.
  void waitForStep(std::uint64_t step) {
    wait([&] { return step_ >= step; }, "the run does not go on");
  }
  /// Asks for a handover and waits for what comes of it and, if it is done, for its step.
  struct Answer {
    msg::SwapOutcome outcome;
    std::int64_t asked_ns = 0;
    std::int64_t effect_ns = 0;
  };
  Answer handOver(const std::string& target) {
    msg::SwapRequest request;
    request.request_id(++last_request_);
    request.target(target);
    request.blend_ns(-1);
    {
      const std::lock_guard lock(mutex_);
      outcome_.reset();
    }
    Answer answer;
    answer.asked_ns = std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    swaps_.write(request);
    wait([&] { return outcome_ && outcome_->request_id() == request.request_id(); }, "no outcome of a handover");
    {
      const std::lock_guard lock(mutex_);
      answer.outcome = *outcome_;
    }
    if (!answer.outcome.done()) return answer;
    waitForStep(answer.outcome.at_step());  // the state may come behind the outcome
    const std::lock_guard lock(mutex_);
    answer.effect_ns = sent_ns_.at(answer.outcome.at_step());
    return answer;
  }
  void stop() {
    msg::SimRequest request;
    request.request_id(++last_request_);
    request.action(msg::SIM_STOP);
    requests_.write(request);
  }

 private:
  void onState(const msg::PlantState& state, const dds::RawSample& sample) {
    const std::lock_guard lock(mutex_);
    plant_ = dds::prefixOf(sample.writer);
    step_ = state.step();
    holder_ = state.holder().c_str();
    sent_ns_[state.step()] = sample.source_timestamp_ns;
    if (sent_ns_.size() > kRemembered) sent_ns_.erase(sent_ns_.begin());
    changed_.notify_all();
  }
  void onOutcome(const msg::SwapOutcome& outcome) {
    const std::lock_guard lock(mutex_);
    if (outcome.request_id() == 0) {
      ++failovers_;
    } else {
      outcome_ = outcome;
    }
    changed_.notify_all();
  }
  template <class Condition>
  void wait(const Condition& condition, const char* otherwise) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, kPatience, condition)) throw UnavailableError(otherwise);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<dds::GuidPrefix> plant_;
  std::uint64_t step_ = 0;
  std::string holder_;
  std::uint64_t failovers_ = 0;
  std::map<std::uint64_t, std::int64_t> sent_ns_;  // of the latest states
  std::optional<msg::SwapOutcome> outcome_;
  std::uint64_t last_request_ = 0;
  dds::Participant participant_;
  dds::Reader<msg::PlantState> states_;
  dds::Reader<msg::SwapOutcome> outcomes_;
  dds::Writer<msg::SwapRequest> swaps_;
  dds::Writer<msg::SimRequest> requests_;
};

/// The controller behind that one, and behind the last the first; the first also when nobody holds the baton.
const std::string& nextTo(const std::string& holder, const Scenario& scenario) {
  const auto& all = scenario.controllers;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    if (all[i].name == holder) return all[i + 1].name;
  }
  return all.front().name;
}

/// Where we are, on a terminal.
void show(const SwapCase& one, int done, int swaps) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r\033[K%s: handover %d of %d", one.name.c_str(), done, swaps);
  if (done == swaps) std::fputs("\r\033[K", stderr);
}

}  // namespace

const std::vector<SwapCase>& allSwapCases() {
  static const std::vector<SwapCase> all{{.name = "realtime", .is_realtime = true}, {.name = "lockstep"}};
  return all;
}

Handovers measureHandovers(const SwapCase& one, int swaps, const std::vector<std::string>& scheduling,
                           Programs& programs) {
  const std::string file = programs.write("swap.yaml", scenarioText(one));
  const Scenario scenario = loadScenario(file);
  const std::string cell = "bench-" + std::to_string(getpid());
  Operator person(programs.domain(), cell);
  std::vector<std::string> arguments{
      "run", file, "--open", "--cell", cell, "--domain", std::to_string(programs.domain()), "--json"};
  arguments.insert(arguments.end(), scheduling.begin(), scheduling.end());
  programs.start("baton", arguments, static_cast<int>(ExitCode::kFailed));  // a holder may lose the baton
  programs.waitUntil([&] { return person.isConnected(); });
  // A force law is only fit for contact.
  programs.waitUntil([&] { return person.step() >= kContactWithin_steps; });

  Handovers made;
  made.step_s = scenario.stepSeconds();
  made.margin_steps = scenario.baton.margin_steps;
  std::mt19937 random(1);  // the same each time
  std::uniform_int_distribution<int> within_step_us(0, static_cast<int>(scenario.step_ns / 1000));
  for (int i = 0; i < swaps; ++i) {
    show(one, i, swaps);
    std::this_thread::sleep_for(std::chrono::microseconds(within_step_us(random)));
    const Operator::Answer answer = person.handOver(nextTo(person.holder(), scenario));
    const msg::SwapOutcome& outcome = answer.outcome;
    if (outcome.done()) {
      made.asked_to_effect_ms.push_back(static_cast<double>(answer.effect_ns - answer.asked_ns) * 1e-6);
      made.steps.push_back(outcome.at_step() - outcome.decided_at_step());
      person.waitForStep(outcome.at_step() + outcome.blend_steps() + 1);
    } else {
      if (made.refused++ == 0) made.refusal = outcome.reason().c_str();
      person.waitForStep(person.step() + 10);
    }
    programs.waitUntil([] { return true; });  // interrupted?
  }
  show(one, swaps, swaps);
  made.lost = person.failovers();
  person.stop();
  made.timing = jsonIn(programs.finish().front()).at("timing");
  return made;
}

}  // namespace baton::bench
