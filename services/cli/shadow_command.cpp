#include "shadow_command.hpp"

#include <filesystem>
#include <memory>
#include <string>

#include "report/shadow.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

struct ShadowRequest {
  RecordingWish recording;
  std::string out;
  bool json = false;
};

void shadow(const ShadowRequest& request, ExitCode& exit_code) {
  const mcap::FileList files = findRecording(request.recording, exit_code);
  const RecordedEfforts run = readEfforts(files);
  if (!run.trace.is_complete) sayWarning(files.string() + ": not certified complete");
  const Shadow table = shadowOf(run);
  const fs::path stem = fs::path(request.out) / (run.trace.scenario.name + "_shadow");
  if (request.json) {
    nlohmann::ordered_json json = toJson(table);
    if (!request.out.empty()) json["drawing"] = stem.string() + ".svg";
    sayText(toText(json) + '\n');
  } else {
    sayText(toText(table));
  }
  if (request.out.empty()) return;
  makeFolder(request.out);
  draw(stem, run.trace.scenario.name + ": what each controller commanded, or would have", shadowPanels(run),
       {{.label = "", .trace = &run.trace}});
  if (!request.json) say("%s.svg\n", stem.c_str());
}

}  // namespace

void addShadowCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<ShadowRequest>();
  CLI::App* command =
      app.add_subcommand("shadow", "what each controller of a recorded run would have done, beside what was applied");
  command->footer(
      "Of the steps in which a controller stood by: its effort minus what the joint felt over the same step, as rms\n"
      "and largest value; and as jump, the largest change against the step before that a handover without any help\n"
      "would have made. A dash: it did not compute while it stood by.");
  addRecording(*command, request->recording);
  command->add_option("--out", request->out, "folder for a drawing of all efforts over time, SVG and PNG");
  command->add_flag("--json", request->json, "print JSON");
  command->callback([=, &exit_code] { shadow(*request, exit_code); });
}

}  // namespace baton
