/// What the page of figures shows, read from deploy/figures/report.yaml, whose head documents the format.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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
  std::string scenario;  // a file's stem below deploy/scenarios/report
  std::string label;     // in legends
};

struct Figure {
  std::string number;  // as the report numbers it: "30, 31, 32"
  std::string title;
  std::string claim;    // what the report says
  std::string theory;   // what is to be expected, with the equation
  std::string finding;  // what follows for the claim
  ClaimVerdict verdict = ClaimVerdict::kHolds;
  std::vector<FigureRun> runs;
  std::vector<std::string> plots;
  std::vector<CheckRequest> checks;
};

struct Erratum {
  std::string where;  // section, equation or figure of the report
  std::string printed;
  std::string right;
  std::string evidence;  // which figure of ours shows it
};

struct FigureList {
  std::vector<Figure> figures;
  std::vector<Erratum> errata;
};

/// Throws UsageError with file, line, what was expected and what was found.
[[nodiscard]] FigureList readFigureList(const std::filesystem::path& file);

}  // namespace baton
