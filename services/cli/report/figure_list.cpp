#include "figure_list.hpp"

#include <algorithm>

#include "control/nearest_name.hpp"
#include "plot.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxText = 2000;  // of a paragraph
constexpr std::size_t kMaxEntries = 200;

/// A name out of a list that somebody else keeps.
std::string known(const YamlNode& node, const char* kind, const std::vector<std::string>& names) {
  std::string name = node.text();
  if (std::find(names.begin(), names.end(), name) == names.end()) node.fail(unknownName(kind, name, names));
  return name;
}

FigureRun readRun(const YamlNode& node) {
  const YamlMap run = node.map({"scenario", "label"});
  FigureRun read{.scenario = run["scenario"].name(), .label = {}};
  if (const auto label = run.find("label")) read.label = label->text();
  return read;
}

CheckRequest readCheck(const YamlNode& node, std::size_t runs) {
  const YamlMap check = node.map({"name", "run", "other"});
  const auto last = static_cast<std::int64_t>(runs) - 1;
  CheckRequest read{.name = known(check["name"], "check", checkNames()), .other = {}};
  read.run = static_cast<int>(check.integerOr("run", 0, last, 0));
  if (const auto other = check.find("other")) read.other = static_cast<int>(other->integer(0, last));
  return read;
}

ChartRequest readChart(const YamlNode& node, std::size_t runs) {
  const YamlMap chart = node.map({"name", "run"});
  return {.name = known(chart["name"], "chart", chartNames()),
          .run = static_cast<int>(chart.integerOr("run", 0, static_cast<std::int64_t>(runs) - 1, 0))};
}

void readChecks(const YamlMap& map, Figure& figure) {
  for (const YamlNode& check : map["checks"].list(1, kMaxEntries)) {
    figure.checks.push_back(readCheck(check, figure.runs.size()));
  }
}

/// What figures and studies have in common.
Figure readCommon(const YamlMap& map) {
  Figure figure;
  figure.title = map["title"].text();
  figure.theory = map["theory"].text(kMaxText);
  figure.finding = map["finding"].text(kMaxText);
  for (const YamlNode& run : map["runs"].list(1, 8)) figure.runs.push_back(readRun(run));
  return figure;
}

Figure readFigure(const YamlNode& node) {
  const YamlMap map =
      node.map({"figure", "title", "claim", "theory", "finding", "claim_holds", "runs", "plots", "until_s", "checks"});
  Figure figure = readCommon(map);
  readChecks(map, figure);
  figure.number = map["figure"].text();
  figure.claim = map["claim"].text(kMaxText);
  figure.verdict = map["claim_holds"].oneOf<ClaimVerdict>({{"true", ClaimVerdict::kHolds},
                                                           {"partly", ClaimVerdict::kPartly},
                                                           {"false", ClaimVerdict::kWrong},
                                                           {"none", ClaimVerdict::kNone}});
  figure.folder = "report";
  for (const YamlNode& plot : map["plots"].list(1, 8)) figure.plots.push_back(known(plot, "plot", plotKinds()));
  figure.until_s = map.numberOr("until_s", {.minimum = 0.0, .maximum = 1e6, .unit = "s"}, 0.0);
  return figure;
}

Figure readStudy(const YamlNode& node) {
  const YamlMap map =
      node.map({"study", "title", "question", "theory", "finding", "folder", "runs", "charts", "checks", "table"});
  Figure figure = readCommon(map);
  figure.is_study = true;
  figure.number = map["study"].text();
  figure.claim = map["question"].text(kMaxText);
  figure.verdict = ClaimVerdict::kNone;
  figure.folder = map["folder"].name();
  if (const auto table = map.find("table")) {  // brings its own checks
    figure.has_pairs = table->oneOf<bool>({{"pairs", true}});
    return figure;
  }
  readChecks(map, figure);
  for (const YamlNode& chart : map["charts"].list(1, 8)) figure.charts.push_back(readChart(chart, figure.runs.size()));
  return figure;
}

Erratum readErratum(const YamlNode& node, const std::vector<Figure>& figures) {
  const YamlMap map = node.map({"where", "printed", "right", "evidence", "printed_cannot_run", "figures"});
  Erratum erratum{.where = map["where"].text(kMaxText),
                  .printed = map["printed"].text(kMaxText),
                  .right = map["right"].text(kMaxText),
                  .evidence = map["evidence"].text(kMaxText),
                  .printed_cannot_run = map.booleanOr("printed_cannot_run", false),
                  .figures = {}};
  std::vector<std::string> numbers;
  numbers.reserve(figures.size());
  for (const Figure& figure : figures) numbers.push_back(figure.number);
  if (const auto named = map.find("figures")) {
    for (const YamlNode& one : named->list(1, 8)) erratum.figures.push_back(known(one, "figure", numbers));
  }
  return erratum;
}

}  // namespace

FigureList readFigureList(const std::filesystem::path& file) {
  const YamlMap map = YamlNode::parse(file.string(), readYamlFile(file.string())).map({"figures", "studies", "errata"});
  FigureList list;
  for (const YamlNode& figure : map["figures"].list(1, kMaxEntries)) list.figures.push_back(readFigure(figure));
  for (const YamlNode& study : map["studies"].list(0, kMaxEntries)) list.figures.push_back(readStudy(study));
  for (const YamlNode& erratum : map["errata"].list(0, kMaxEntries)) {
    list.errata.push_back(readErratum(erratum, list.figures));
  }
  return list;
}

}  // namespace baton
