#include "whatif_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.hpp"
#include "messages/parameters.hpp"
#include "report/gnuplot.hpp"
#include "report/plot.hpp"
#include "report/theory_tools.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"
#include "whatif/command_file.hpp"
#include "whatif/counterfactual.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

struct WhatIfRequest {
  RecordingWish recording;
  mcap::FileList files;  // found
  CounterfactualWish wish;
  std::string out;
  bool json = false;
};

/// Both efforts over the run, as its drawing has them.
class Curves {
 public:
  explicit Curves(const mcap::FileList& file) : trace_(readTrace(file)), effort_(none()), recorded_(none()) {}

  void add(const RecordedStep& step, const JointVector& effort) {
    const auto k = static_cast<Eigen::Index>(step.step - trace_.first_step);
    effort_.col(k) = effort;
    if (const auto* recorded = step.effort(); recorded != nullptr && *recorded) recorded_.col(k) = **recorded;
  }

  [[nodiscard]] const Scenario& scenario() const { return trace_.scenario; }

  void drawTo(const fs::path& stem, const std::string& law, const std::string& place) const {
    const int n = trace_.scenario.robot.size();
    std::vector<Panel> panels;
    panels.reserve(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      panels.push_back(
          {.y_label = fmt::format("\u03c4_{{{}}} [{}]", i + 1, theory::effortUnit(trace_.scenario.robot, i)),
           .curves = {{law, &trace_, effort_.row(i), 0, false}, {"recorded", &trace_, recorded_.row(i), 0, true}}});
    }
    draw(stem, trace_.scenario.name + ": what if " + law + " were " + place, panels, {{.label = "", .trace = &trace_}});
  }

 private:
  [[nodiscard]] Eigen::MatrixXd none() const {
    return Eigen::MatrixXd::Constant(trace_.scenario.robot.size(), trace_.steps(),
                                     std::numeric_limits<double>::quiet_NaN());
  }
  Trace trace_;
  Eigen::MatrixXd effort_;
  Eigen::MatrixXd recorded_;
};

mcap::StringMap aboutOf(const Counterfactual& made, const mcap::FileList& file) {
  return {{"recording", fs::absolute(file.first()).string()},
          {"run", made.run},
          {"run_hash", std::to_string(made.run_hash)},
          {"law", made.law},
          {"parameters", toText(made.parameters)},
          {"place", placeOf(made.wish)},
          {"version", BATON_VERSION}};
}

/// The drawing and the commands, without their extensions.
fs::path stemOf(const WhatIfRequest& request, const Scenario& scenario) {
  const CounterfactualWish& wish = request.wish;
  std::string name = scenario.name + "_whatif_" + (wish.law.empty() ? wish.as : wish.law);
  if (!wish.law.empty() && !wish.as.empty()) name += "_as_" + wish.as;
  if (wish.in_shadow) name += "_shadow";
  return fs::path(request.out) / name;
}

/// Writes the drawing and the commands; returns the table and the files' names.
Counterfactual makeWithFiles(const WhatIfRequest& request, const std::function<void(double)>& progress,
                             std::vector<std::string>& files) {
  expectGnuplot();
  Curves curves(request.files);
  const fs::path stem = stemOf(request, curves.scenario());
  const std::string file = stem.string() + ".mcap";
  makeFolder(request.out);
  for (const fs::path& read : request.files.paths()) {
    std::error_code missing;
    if (!fs::equivalent(file, read, missing)) continue;
    throw UsageError("--out " + request.out + ": expected a folder other than that of a recording called " + file);
  }
  std::optional<CommandFile> commands;  // made once it is sure that there is something to write
  const auto open = [&] {
    const std::string author = request.wish.as.empty() ? request.wish.law : request.wish.as;
    if (!commands) commands.emplace(file, author, curves.scenario().step_ns);
  };
  Counterfactual made = counterfactual(
      request.files, request.wish,
      [&](const RecordedStep& step, const JointVector& effort, std::uint64_t inputs_hash) {
        curves.add(step, effort);
        open();
        commands->write(step, effort, inputs_hash);
      },
      progress);
  open();
  commands->close(aboutOf(made, request.files));
  curves.drawTo(stem, made.law, placeOf(made.wish));
  files = {stem.string() + ".svg", file};
  return made;
}

void whatIf(const WhatIfRequest& request) {
  ProgressLine line;
  const auto progress = [&](double part) { line.show(progressBar(part)); };
  progress(0.0);  // what was decided in the run is read first
  std::vector<std::string> files;
  const Counterfactual made = request.out.empty() ? counterfactual(request.files, request.wish, {}, progress)
                                                  : makeWithFiles(request, progress, files);
  line.show("");
  if (!made.is_complete) sayWarning(request.files.string() + ": not certified complete");
  if (request.json) {
    nlohmann::ordered_json json = toJson(made);
    if (!files.empty()) json["files"] = files;
    sayText(toText(json) + '\n');
    return;
  }
  sayText(toText(made));
  for (const std::string& file : files) say("%s\n", file.c_str());
}

}  // namespace

void addWhatIfCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<WhatIfRequest>();
  CLI::App* command =
      app.add_subcommand("whatif", "what another law, or other values, would have commanded in a recorded run");
  command->footer(
      "The law is given at every step what the holder of the baton was given: state, contact, reference. The arm goes\n"
      "where the recording says and does not feel the law, so an integrator of it may wind up; `baton branch` lets\n"
      "the arm go another way. It holds the baton from the first step to the last unless --as or --shadow say\n"
      "otherwise.\n"
      "  baton whatif run.mcap --law joint_pd --set kp=40     the law with its defaults and what is set\n"
      "  baton whatif run.mcap --as impedance                 the controller as it was: reproduces its torque exactly\n"
      "  baton whatif run.mcap --as impedance --set kp=300    the same with another value; recorded changes of kp do\n"
      "                                                       not count, those of other parameters do\n"
      "  baton whatif run.mcap --law force_pi --as impedance  another law in its place, with its defaults\n"
      "Compared with what the holder commanded; while the brake held, with what the joints felt.\n"
      "Exit codes: 0 done, whatever the difference; 2 no such law, value or controller, no contact for a law that\n"
      "uses force, no recording of a run, or one without a topic that is needed; 3 no such file, or one that cannot\n"
      "be written.");
  addRecording(*command, request->recording);
  command->add_option("--law", request->wish.law, "the law (see `baton laws`)");
  command->add_option("--as", request->wish.as,
                      "the controller in whose place: it holds the baton when that one did, and stands by when that "
                      "one did; without --law also its law and its values");
  command->add_option("--set", request->wish.settings, "parameter=value, as in a scenario; may be given more than once")
      ->allow_extra_args(false);
  command->add_flag("--shadow", request->wish.in_shadow,
                    "stand by at every step: what it would have commanded had it received the baton there");
  command->add_option("--out", request->out,
                      "folder for a drawing (SVG, PNG) and the commands (MCAP, topic whatif_command)");
  command->add_flag("--json", request->json, "print JSON");
  command->callback([=, &exit_code] {
    request->files = findRecording(request->recording, exit_code);
    whatIf(*request);
  });
}

}  // namespace baton
