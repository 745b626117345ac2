#include "chart.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "gnuplot.hpp"

namespace baton {
namespace {

const char* styleOf(ChartSeries::Style style) {
  switch (style) {
    case ChartSeries::Style::kLine: return "lines lw 1.6";
    case ChartSeries::Style::kDashes: return "lines lw 1.4 dt 2";
    case ChartSeries::Style::kDots: return "points pt 7 ps 0.6";
    case ChartSeries::Style::kCircles: return "points pt 6 ps 0.8";
    case ChartSeries::Style::kCrosses: return "points pt 2 ps 0.6";
  }
  return "";
}

std::string dataOf(const Chart& chart) {
  std::ostringstream data;
  data.precision(9);
  for (std::size_t p = 0; p < chart.panels.size(); ++p) {
    const std::vector<ChartSeries>& series = chart.panels[p].series;
    for (std::size_t s = 0; s < series.size(); ++s) {
      data << fmt::format("$data_{}_{} << end\n", p, s);
      for (const Eigen::Vector2d& point : series[s].points) data << point.x() << ' ' << point.y() << '\n';
      data << "end\n";
    }
  }
  return data.str();
}

/// Powers of ten; over less than two of them 1, 2 and 5 as well, since there might be but one to read.
std::string logTics(const ChartPanel& panel, bool of_x) {
  const char* axis = of_x ? "x" : "y";
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const ChartSeries& series : panel.series) {
    for (const Eigen::Vector2d& point : series.points) {
      const double value = of_x ? point.x() : point.y();
      if (value > 0.0) low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (!(low < high) || high / low > 100.0)
    return fmt::format("set format {0} '10^{{%T}}'\nset {0}tics autofreq\n", axis);
  std::string tics;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10.0) {
    for (const double digit : {1.0, 2.0, 5.0}) tics += fmt::format("{}{:g}", tics.empty() ? "" : ", ", digit * decade);
  }
  return fmt::format("set format {0} '%g'\nset {0}tics ({1})\n", axis, tics);
}

std::string commandsFor(const std::string& title, const Chart& chart) {
  std::ostringstream commands;
  commands << fmt::format("set multiplot layout 1,{} title {} noenhanced\n", chart.panels.size(), quoted(title));
  // Beside panels there is no room for a legend.
  commands << "set grid lc rgb '#dddddd'\n"
           << (chart.panels.size() == 1 ? "set key outside right top vertical samplen 2\n"
                                        : "set key outside bottom center vertical maxrows 4 samplen 2\nset bmargin 8\n")
           << "set autoscale noextend\nset offsets graph 0.04, graph 0.04, graph 0.04, graph 0.04\n";
  for (std::size_t p = 0; p < chart.panels.size(); ++p) {
    const ChartPanel& panel = chart.panels[p];
    commands << fmt::format("set title {} noenhanced\nset xlabel {}\nset ylabel {}\n", quoted(panel.title),
                            quoted(panel.x_label), quoted(panel.y_label));
    for (const auto& [axis, is_log] : {std::pair{"x", panel.log_x}, std::pair{"y", panel.log_y}}) {
      commands << (is_log ? fmt::format("set logscale {0}\n{1}", axis, logTics(panel, axis[0] == 'x'))
                          : fmt::format("unset logscale {0}\nset format {0}\nset {0}tics autofreq\n", axis));
    }
    commands << "plot ";
    for (std::size_t s = 0; s < panel.series.size(); ++s) {
      const ChartSeries& series = panel.series[s];
      commands << fmt::format("{}$data_{}_{} using 1:2 with {} lc rgb '{}' ", s == 0 ? "" : ", ", p, s,
                              styleOf(series.style), kCurveColours[series.colour % std::size(kCurveColours)])
               << (series.label.empty() ? "notitle" : fmt::format("title {} noenhanced", quoted(series.label)));
    }
    commands << '\n';
  }
  commands << "unset multiplot\n";
  return commands.str();
}

}  // namespace

void draw(const std::filesystem::path& stem, const std::string& title, const Chart& chart) {
  drawScript(stem, {std::max<std::size_t>(860, 120 + 370 * chart.panels.size()), 460}, dataOf(chart),
             commandsFor(title, chart));
}

}  // namespace baton
