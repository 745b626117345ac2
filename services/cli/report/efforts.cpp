#include "efforts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "recording.hpp"

namespace baton {
namespace {

/// Puts the messages of a file where they belong, in whatever order they come.
class EffortFiller {
 public:
  explicit EffortFiller(RecordedEfforts& run) : run_(run), states_(static_cast<std::size_t>(run.trace.steps())) {
    const Scenario& scenario = run.trace.scenario;
    run.effort.assign(scenario.controllers.size(),
                      Eigen::MatrixXd::Constant(scenario.robot.size(), run.trace.steps(), kNan));
    run.holder.assign(states_.size(), RecordedEfforts::kUnknown);
  }

  void operator()(const msg::PlantState& state) {
    const Eigen::Index k = column(state.step());
    if (k < 0) return;
    const auto step = static_cast<std::size_t>(k);
    ++states_[step];
    run_.holder[step] = state.holder().size() == 0 ? RecordedEfforts::kBrake : indexOf(state.holder().c_str());
  }

  void operator()(const msg::JointCommand& command) {
    const Eigen::Index k = column(command.step());
    const int who = indexOf(command.controller().c_str());
    const auto n = static_cast<std::size_t>(run_.trace.scenario.robot.size());
    if (k < 0 || who < 0 || command.effort().size() != n) return;
    const Eigen::VectorXd effort = Eigen::Map<const Eigen::VectorXd>(command.effort().data(), static_cast<int>(n));
    Eigen::MatrixXd& all = run_.effort[static_cast<std::size_t>(who)];
    // A late step is asked for again and answered again, with the same.
    if (!all.col(k).array().isNaN().any() && all.col(k) != effort) contradicted_.push_back({k, who});
    all.col(k) = effort;
  }

  void operator()(const msg::SwapOutcome& outcome) {
    if (!outcome.done() && !outcome.dry_run()) run_.refused.push_back(outcome);
  }
  void operator()(const msg::SwapReport& report) { run_.reports.push_back(report); }

  /// The last step is open: nobody need have commanded for it.
  void countSteps() {
    std::vector<bool> is_doubled(states_.size());
    for (const auto& [k, who] : contradicted_) {
      if (run_.holder[static_cast<std::size_t>(k)] == who) is_doubled[static_cast<std::size_t>(k)] = true;
    }
    for (std::size_t k = 0; k < states_.size(); ++k) {
      if (states_[k] > 1) is_doubled[k] = true;
      const int holder = run_.holder[k];
      const bool is_open = k + 1 == states_.size();
      const bool has_command =
          holder < 0 || !run_.effort[static_cast<std::size_t>(holder)].col(static_cast<Eigen::Index>(k)).hasNaN();
      if (states_[k] == 0 || (!is_open && !has_command)) ++run_.lost_steps;
    }
    run_.doubled_steps = static_cast<std::uint64_t>(std::count(is_doubled.begin(), is_doubled.end(), true));
  }

 private:
  struct Contradiction {
    Eigen::Index k;
    int who;
  };

  [[nodiscard]] Eigen::Index column(std::uint64_t step) const {
    const std::uint64_t k = step - run_.trace.first_step;  // of an earlier step: a large number
    return k < static_cast<std::uint64_t>(run_.trace.steps()) ? static_cast<Eigen::Index>(k) : -1;
  }
  [[nodiscard]] int indexOf(const char* name) const { return controllerIndex(run_.trace.scenario, name); }

  RecordedEfforts& run_;
  std::vector<int> states_;
  std::vector<Contradiction> contradicted_;
};

}  // namespace

Eigen::VectorXd RecordedEfforts::applied(Eigen::Index k) const {
  if (k + 1 < trace.steps()) return trace.tau.col(k + 1);
  return Eigen::VectorXd::Constant(trace.tau.rows(), kNan);
}

int controllerIndex(const Scenario& scenario, std::string_view name) {
  const auto& all = scenario.controllers;
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  return found == all.end() ? RecordedEfforts::kUnknown : static_cast<int>(found - all.begin());
}

RecordedEfforts readEfforts(const mcap::FileList& file) { return readEfforts(file, readTrace(file)); }

RecordedEfforts readEfforts(const mcap::FileList& file, Trace trace) {
  RecordedEfforts run;
  run.trace = std::move(trace);
  const mcap::JoinedReader reader(file);
  if (reader.info().is_cut) run.cut = reader.info().problem;
  EffortFiller fill(run);
  const auto read = [&]<class M>(const mcap::MessageView& view, const dds::Topic<M>& topic) {
    M message;
    if (view.channel->topic == topic.name && dds::decode(view.data, message)) fill(message);
  };
  using namespace dds::topics;
  reader.forEachMessage(
      {.topics = {kPlantState.name, kJointCommand.name, kShadowCommand.name, kSwapOutcome.name, kSwapReport.name},
       .start_time_ns = lastTakeBegin(reader),
       .order = mcap::MessageFilter::Order::kFile},
      [&](const mcap::MessageView& view) {
        read(view, kPlantState);
        read(view, kJointCommand);
        read(view, kShadowCommand);
        read(view, kSwapOutcome);
        read(view, kSwapReport);
      });
  fill.countSteps();
  return run;
}

}  // namespace baton
