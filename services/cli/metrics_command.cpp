#include "metrics_command.hpp"

#include <memory>
#include <string>

#include "report/metrics.hpp"
#include "runtime/json.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {

void addMetricsCommand(CLI::App& app, ExitCode& exit_code) {
  const auto wish = std::make_shared<RecordingWish>();
  const auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("metrics", "errors, efforts and contact forces of a recorded run, in numbers");
  command->footer(
      "Errors are desired minus actual. Overshoot and settling are of the way from where a signal starts to its\n"
      "set-point; settled means within 2 % of that way for good. A dash: the desired value moves, there is no way,\n"
      "the recording begins in the middle of the run, or what it takes was not recorded.\n"
      "Exit codes: 0 done; 1 the recording is cut, or a part is missing, and the rest was used; 2 damaged or not the\n"
      "recording of a run; 3 cannot be opened.");
  addRecording(*command, *wish);
  command->add_flag("--json", *json, "print JSON");
  command->callback([=, &exit_code] {
    const mcap::FileList files = findRecording(*wish, exit_code);
    const Trace trace = readTrace(files);
    warnIfIncomplete(files.string(), trace.info, exit_code);
    if (trace.info.is_complete && !trace.is_complete) sayWarning(files.string() + " is not certified complete");
    const Metrics metrics = metricsOf(trace);
    sayText((*json ? toText(toJson(metrics)) : toText(metrics)) + '\n');
  });
}

}  // namespace baton
