#include "rerun.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "base/plural.hpp"
#include "report/recording.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

/// What was decided up to the last recorded step has to be decided again, so the end may not be nearer to it than a
/// handover takes; and what is saved at the end of a run is not saved where a run was stopped.
std::uint64_t endOf(const RecordedRun& run) {
  const std::uint64_t behind = run.last_step + run.scenario.baton.margin_steps + 2;
  return run.scenario.end_step == 0 ? behind : std::min(behind, run.scenario.end_step);
}

}  // namespace

std::string Rerun::text() const {
  std::string differs = "differs: ";
  if (!made_with.empty()) differs += toText(made_with) + "; ";
  if (const auto& parting = comparison.parting) {
    return differs + fmt::format("first at step {} in {}", parting->step, parting->topic);
  }
  if (first_missing && was_interrupted) {
    return fmt::format("interrupted before step {}: identical up to there", *first_missing);
  }
  if (first_missing) {
    return differs + fmt::format("ends before step {}: {}", *first_missing, result.at("reason").get<std::string>());
  }
  return fmt::format("identical: {}, {} taken from the recording, hash {}", counted(steps, "step"),
                     counted(decisions, "decision"), hash);
}

Rerun rerun(const mcap::FileList& recording, const std::filesystem::path& folder, RunRequest run,
            const std::function<ExitCode(RunSession&)>& follow) {
  const RecordedRun original = readRecordedRun(recording);
  if (original.scenario.mode == SimMode::kRealtime) {
    throw UsageError(recording.string() +
                     ": expected a run in lockstep, found realtime, whose bytes depend on what came in time");
  }
  writeFile(folder / "robot.yaml", original.robot_text);
  writeFile(folder / "scenario.yaml", repeatingScenario(original, endOf(original)));
  run.scenario = (folder / "scenario.yaml").string();
  if (original.checkpoint) {
    run.checkpoint = (folder / "checkpoint.mcap").string();
    writeFile(run.checkpoint, *original.checkpoint);
  }
  Rerun made;
  {
    RunSession session(run, true);
    (void)follow(session);
    made.was_interrupted = session.wasInterrupted();
    made.result = session.result();
    made.recording = session.info().recording;
  }
  const HashedRun then = hashRun(recording);
  HashedRun now;
  // A repetition that ended before its first step has no messages of the loop, or no file.
  if (made.result.at("steps").get<std::uint64_t>() > made.result.at("first_step").get<std::uint64_t>()) {
    now = hashRun(made.recording);
    made.made_with = madeWithDifferences(metadataOf(mcap::JoinedReader(recording), "baton.run"),
                                         metadataOf(mcap::Reader(made.recording), "baton.run"));
  }
  made.comparison = compare(then, now);
  made.steps = then.steps.size();
  made.decisions = original.decisions.size();
  made.hash = then.hash();
  for (const auto& [step, hashes] : then.steps) {
    if (now.steps.contains(step)) continue;
    made.first_missing = step;
    break;
  }
  return made;
}

}  // namespace baton
