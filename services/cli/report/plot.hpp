/// Drawings of recorded runs, by gnuplot: desired against actual over time, units on the axes, handovers and contact
/// marked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trace.hpp"

namespace baton {

struct LabelledRun {
  std::string label;  // empty when the drawing has one run only
  const Trace* trace = nullptr;
};

/// One quantity of a run over time.
struct Curve {
  std::string label;
  const Trace* trace = nullptr;
  Eigen::RowVectorXd y;     // a value a step; NaN: none
  std::size_t colour = 0;   // the first, second, ...
  bool is_desired = false;  // grey and dashed
};

struct Panel {
  std::string y_label;
  std::vector<Curve> curves;
  bool log_y = false;
};

/// What can be drawn: joints, joint_errors, joint_error_sizes (|e| on a logarithmic axis), goal_errors (from q_d
/// without its noise), tip, tip_errors, angles, efforts, force, force_reference.
[[nodiscard]] const std::vector<std::string>& plotKinds();

/// Writes `stem`.gp, a script with its data, and lets gnuplot make `stem`.svg and `stem`.png of it; all runs go into
/// the same panels, up to `until_s` (0: to their end). Throws UsageError for an unknown kind, UnavailableError when
/// gnuplot is missing or fails.
void draw(const std::filesystem::path& stem, const std::string& title, const std::string& kind,
          const std::vector<LabelledRun>& runs, double until_s);

/// The same of curves that were made elsewhere; handovers and contacts of `runs` are marked.
void draw(const std::filesystem::path& stem, const std::string& title, const std::vector<Panel>& panels,
          const std::vector<LabelledRun>& runs);

}  // namespace baton
