/// Charts of computed numbers: points and lines over any two quantities, where plot.hpp draws recorded runs over time.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace baton {

struct ChartSeries {
  enum class Style { kLine, kDashes, kDots, kCircles, kCrosses };
  std::string label;  // none: not in the legend
  Style style = Style::kLine;
  std::size_t colour = 0;  // of kCurveColours
  std::vector<Eigen::Vector2d> points;
};

struct ChartPanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  bool log_x = false;
  bool log_y = false;
  std::vector<ChartSeries> series;
};

/// Its panels stand side by side.
struct Chart {
  std::vector<ChartPanel> panels;
};

/// Makes `stem`.svg and `stem`.png. Throws UnavailableError when gnuplot is missing or fails.
void draw(const std::filesystem::path& stem, const std::string& title, const Chart& chart);

}  // namespace baton
