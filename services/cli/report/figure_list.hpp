/// What the page of figures shows, read from deploy/figures/report.yaml, whose head documents the format.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study.hpp"
#include "theory.hpp"

namespace baton {

enum class ClaimVerdict {
  kHolds,
  kPartly,
  kWrong,
  kNone,           // nothing is claimed: the figure is there for comparison
  kNotEstablished  // our runs do not agree with theory, so they prove nothing
};

struct FigureRun {
  std::string scenario;  // a file's stem in the figure's folder
  std::string label;     // in legends
};

/// A figure of the report, or one of a study of ours, which has a question instead of a claim and may have charts
/// or tables.
struct Figure {
  bool is_study = false;
  std::string number;  // as the report numbers it: "30, 31, 32"; a study's name and part: "co-simulation, error"
  std::string title;
  std::string claim;    // what the report says, or what the study asks
  std::string theory;   // what is to be expected, with the equation
  std::string finding;  // what follows for the claim
  ClaimVerdict verdict = ClaimVerdict::kHolds;
  std::string folder;  // of the scenarios, below deploy/scenarios
  std::vector<FigureRun> runs;
  std::vector<std::string> plots;
  double until_s = 0.0;  // where the plots end; 0: with the runs
  std::vector<ChartRequest> charts;
  bool has_pairs = false;  // each run is shown as a table of its handovers, law by law
  std::vector<CheckRequest> checks;
};

struct Erratum {
  std::string where;  // section, equation or figure of the report
  std::string printed;
  std::string right;
  std::string evidence;              // what shows it
  bool printed_cannot_run = false;   // only what is right has been run
  std::vector<std::string> figures;  // on which that rests, by their numbers; none: on tests, or on looking
};

struct FigureList {
  std::vector<Figure> figures;  // the report's, then those of studies
  std::vector<Erratum> errata;
};

/// Throws UsageError with file, line, what was expected and what was found.
[[nodiscard]] FigureList readFigureList(const std::filesystem::path& file);

}  // namespace baton
