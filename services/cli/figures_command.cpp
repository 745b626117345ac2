#include "figures_command.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "control/nearest_name.hpp"
#include "report/batch.hpp"
#include "report/gnuplot.hpp"
#include "report/page.hpp"
#include "report/pairs.hpp"
#include "report/plot.hpp"
#include "report/run_settings.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct FiguresRequest {
  std::vector<std::string> only;
  std::string out = "figures";
  BatchOptions batch;
  bool json = false;
};

/// "27-29" and "30, 31" by each of their numbers, "co-simulation, error" by what stands before the comma: what can be
/// given to --only, where a comma begins another name.
std::set<std::string> namesOf(const Figure& figure) {
  std::set<std::string> names{figure.number.substr(0, figure.number.find(','))};
  std::vector<int> numbers;
  bool is_range = false;
  for (std::size_t i = 0; i < figure.number.size();) {
    if (std::isdigit(static_cast<unsigned char>(figure.number[i])) == 0) {
      is_range = is_range || figure.number[i] == '-';
      ++i;
      continue;
    }
    std::size_t length = 0;
    numbers.push_back(std::stoi(figure.number.substr(i), &length));
    i += length;
  }
  for (const int number : numbers) names.insert(std::to_string(number));
  if (is_range && numbers.size() == 2) {
    for (int number = numbers[0]; number <= numbers[1]; ++number) names.insert(std::to_string(number));
  }
  return names;
}

std::vector<Figure> chosen(const std::vector<Figure>& all, const std::vector<std::string>& only) {
  if (only.empty()) return all;
  std::vector<std::string> known;  // in the report's order
  std::vector<Figure> figures;
  for (const Figure& figure : all) {
    const std::set<std::string> names = namesOf(figure);
    for (const std::string& name : names) {
      if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
    }
    if (std::any_of(only.begin(), only.end(), [&](const auto& name) { return names.contains(name); })) {
      figures.push_back(figure);
    }
  }
  for (const std::string& name : only) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw UsageError(unknownName("figure", name, known));
  }
  return figures;
}

std::vector<fs::path> scenariosOf(const std::vector<Figure>& figures) {
  std::vector<fs::path> files;
  for (const Figure& figure : figures) {
    for (const FigureRun& run : figure.runs) {
      const fs::path file = findScenario(figure.folder + "/" + run.scenario);
      if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

ProgressLine& progressLine() {
  static ProgressLine line;
  return line;
}

/// What is being drawn, and how much of it is done.
void showProgress(const Figure& figure, double part) {
  progressLine().show("drawing figure " + figure.number + (part > 0.0 ? fmt::format(": {:.0f} %", 100.0 * part) : ""));
}

/// Fills in what is seen of a figure.
void complete(FigureResult& result, const std::map<std::string, BatchRun>& runs, const fs::path& out) {
  const Figure& figure = result.figure;
  std::vector<Trace> traces;
  traces.reserve(figure.runs.size());  // the drawings point into it
  std::vector<LabelledRun> labelled;
  for (const FigureRun& run : figure.runs) {
    const BatchRun& done = runs.at(run.scenario);
    if (!done.failure.empty()) {
      result.failure = run.scenario + ": " + done.failure;
      return;
    }
    traces.push_back(readTrace(done.recording));
    result.settings.push_back(settingsText(traces.back().scenario));
    labelled.push_back({figure.runs.size() > 1 ? run.label : "", &traces.back()});
  }
  const auto add = [&](Check&& check, const std::string& label) {
    if (figure.runs.size() > 1 && !label.empty()) check.what = label + ": " + check.what;
    result.checks.push_back(std::move(check));
  };
  for (const CheckRequest& request : figure.checks) {
    const std::string& label = figure.runs[static_cast<std::size_t>(request.run)].label;
    for (Check& check : runCheck(request, traces)) add(std::move(check), request.other ? "" : label);
  }
  for (const LabelledRun& run : labelled) {
    result.checks.push_back(followsScenario(*run.trace));
    if (!run.label.empty()) result.checks.back().what += ", " + run.label;
  }
  if (figure.has_pairs) {
    for (std::size_t i = 0; i < traces.size(); ++i) {
      const FigureRun& run = figure.runs[i];
      const RecordedEfforts efforts = readEfforts(runs.at(run.scenario).recording, traces[i]);
      const PairTable table = pairsOf(efforts);
      result.tables.push_back(toHtml(table));
      for (Check& check : checksOf(table)) add(std::move(check), run.label);
    }
  }
  for (const std::string& kind : figure.plots) {
    const std::string stem = figure.runs.front().scenario + "_" + kind;
    draw(out / stem, figure.title, kind, labelled, figure.until_s);
    result.drawings.push_back(stem);
  }
  for (const ChartRequest& request : figure.charts) {
    ChartResult made = makeChart(request, traces, [&](double part) { showProgress(figure, part); });
    const FigureRun& base = figure.runs[static_cast<std::size_t>(request.run)];
    const std::string stem = base.scenario + "_" + request.name;
    draw(out / stem, figure.title, made.chart);
    result.drawings.push_back(stem);
    for (Check& check : made.checks) add(std::move(check), base.label);
  }
}

/// What goes wrong with one figure is told in its place, beside what was seen of it: the others are still to be seen.
FigureResult resultOf(const Figure& figure, const std::map<std::string, BatchRun>& runs, const fs::path& out) {
  FigureResult result{.figure = figure, .settings = {}, .drawings = {}, .tables = {}, .checks = {}, .failure = {}};
  try {
    complete(result, runs, out);
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  return result;
}

Json toJson(const FigureResult& result) {
  Json checks = Json::array();
  for (const Check& check : result.checks) {
    checks.push_back({{"what", check.what},
                      {"unit", check.unit},
                      {"predicted", check.predicted},
                      {"measured", check.measured},
                      {"tolerance", check.tolerance},
                      {"relative", check.is_relative},
                      {"passes", check.passes()}});
  }
  return {{"figure", result.figure.number}, {"title", result.figure.title}, {"claim", toString(result.verdict())},
          {"agrees", result.agrees()},      {"failure", result.failure},    {"checks", checks}};
}

void print(const FigureResult& result) {
  const std::string claim = result.figure.is_study ? "" : std::string("claim ") + toString(result.verdict());
  say("%-25s %-58s %-20s %s\n", result.figure.number.c_str(), result.figure.title.c_str(), claim.c_str(),
      !result.failure.empty() ? "NOT COMPLETED"
      : result.agrees()       ? "agrees with theory"
                              : "DIFFERS FROM THEORY");
  if (!result.failure.empty()) say("  %s\n", result.failure.c_str());
  for (const Check& check : result.checks) {
    say("  %s %-62s predicted %14.8g  measured %14.8g %s\n", check.passes() ? " " : "!", check.what.c_str(),
        check.predicted, check.measured, check.unit.c_str());
  }
}

ExitCode figures(FiguresRequest request) {
  const auto begin = std::chrono::steady_clock::now();
  const FigureList list = readFigureList(dataFolder() / "figures/report.yaml");
  const std::vector<Figure> wanted = chosen(list.figures, request.only);
  const fs::path out = fs::absolute(request.out);
  request.batch.folder = out / "recordings";
  expectGnuplot();
  std::map<std::string, BatchRun> runs;
  PageFacts facts{.build = "Baton " BATON_VERSION " (" BATON_COMPILER ", " BATON_FLAGS ")"};
  for (BatchRun& run : runBatch(scenariosOf(wanted), request.batch)) {
    facts.reused += run.was_reused ? 1 : 0;
    ++facts.runs;
    const std::string name = run.scenario;
    runs.emplace(name, std::move(run));
  }
  std::vector<FigureResult> results;
  for (const Figure& figure : wanted) {
    showProgress(figure, 0.0);
    results.push_back(resultOf(figure, runs, out));
  }
  progressLine().clear();
  facts.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const fs::path page = out / (request.only.empty() ? "index.html" : "partial.html");
  writePage(page, results, list.errata, facts);

  Json json = Json::array();
  for (const FigureResult& result : results) {
    if (request.json) {
      json.push_back(toJson(result));
    } else {
      print(result);
    }
  }
  const auto agreeing = std::count_if(results.begin(), results.end(), [](const auto& one) { return one.agrees(); });
  if (request.json) {
    sayText(toText(Json{{"page", page.string()},
                        {"elapsed_s", facts.elapsed_s},
                        {"runs", facts.runs},
                        {"reused", facts.reused},
                        {"figures", json}}) +
            '\n');
  } else {
    say("%zu of %zu figures agree with theory; %zu runs, %zu reused, %.0f s\n%s\n", static_cast<std::size_t>(agreeing),
        results.size(), facts.runs, facts.reused, facts.elapsed_s, page.c_str());
  }
  return static_cast<std::size_t>(agreeing) == results.size() ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addFiguresCommand(CLI::App& app, ExitCode& exit_code) {
  const auto request = std::make_shared<FiguresRequest>();
  request->batch.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command =
      app.add_subcommand("figures", "run the report's scenarios, draw its figures, hold them against theory on a page");
  command->footer(
      "Recordings stay in DIR/recordings and are used again while scenario, robot and build are the same.\n"
      "The page is DIR/index.html, or with --only DIR/partial.html, which leaves the other as it is.\n"
      "Exit codes: 0 every figure agrees with theory, 1 one does not or could not be run.");
  command->add_option("--only", request->only, "only these figures: 9,10")->delimiter(',')->allow_extra_args(false);
  command->add_option("--out", request->out, "folder for the page, the drawings and the recordings")
      ->capture_default_str();
  command->add_option("--jobs", request->batch.jobs, "runs at the same time")
      ->check(wholeBetween(1, 64))
      ->capture_default_str();
  command->add_flag("--fresh", request->batch.fresh, "run everything again");
  addDomain(*command, request->batch.domain)->envname("BATON_DOMAIN");
  addTransport(*command, request->batch.transport);
  command->add_flag("--json", request->json, "print JSON");
  command->callback([=, &exit_code] { exit_code = figures(*request); });
}

}  // namespace baton
