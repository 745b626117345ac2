// The pair table on the page.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "html.hpp"
#include "pairs.hpp"

namespace baton {
namespace {

/// Joint by joint.
std::string joined(const Eigen::VectorXd& values) {
  return fmt::format("{:.3g}", fmt::join(values.begin(), values.end(), ", "));
}

std::string details(const PairHandover& one, const PairTable& table) {
  const std::vector<ControllerConfig>& controllers = table.run->trace.scenario.controllers;
  std::string text = fmt::format("{} to {} at step {}\nchange at K: {}\nthe laws' own: {}\nwithout the blend: {}",
                                 controllers[one.from].name, controllers[one.to].name, one.at_step, joined(one.change),
                                 joined(one.own), joined(one.without_blend));
  if (one.has_report) {
    text += fmt::format(
        "\nover the blend: {:.0f} % of the rate limit, {} hits; {:.3g} J put in, force moves {:.3g} N\ntip at {:.3g} "
        "m/s",
        100.0 * one.rate_share, one.rate_limit_hits, one.blend_energy, one.force_deviation, one.tip_speed);
  }
  return text;
}

/// May be broken into lines.
std::string heading(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return "<th>" + escaped(name);
}

/// The darker, the nearer to what is allowed.
std::string cell(const PairHandover& one, const PairTable& table) {
  const double ratio = one.ratio();
  const bool is_good = ratio <= 1.0 && one.rate_limit_hits == 0;
  return fmt::format(
      "<td class=pair style='background: rgba({}, {:.2f})' title=\"{}\"><span class={}>{:.2f}{}</span><br><small>{:.2g}"
      "</small>",
      is_good ? "44, 140, 74" : "200, 50, 44", is_good ? 0.06 + 0.34 * ratio : 0.5, escaped(details(one, table)),
      is_good ? "agrees" : "differs", ratio, one.rate_limit_hits > 0 ? "!" : "", one.without_blend.maxCoeff());
}

/// The worst of several handovers between the same two.
const PairHandover* worst(const PairTable& table, std::size_t from, std::size_t to) {
  const PairHandover* found = nullptr;
  for (const PairHandover& one : table.handovers) {
    if (one.from == from && one.to == to && (found == nullptr || !(one.ratio() <= found->ratio()))) found = &one;
  }
  return found;
}

const PairRefusal* refusal(const PairTable& table, std::size_t from, std::size_t to) {
  const auto found = std::find_if(table.refusals.begin(), table.refusals.end(),
                                  [&](const PairRefusal& one) { return one.from == from && one.to == to; });
  return found == table.refusals.end() ? nullptr : &*found;
}

}  // namespace

std::string toHtml(const PairTable& table) {
  const Scenario& scenario = table.run->trace.scenario;
  std::string html =
      fmt::format("<p><b>{}</b></p>\n<div class=wide><table><tr><th>from \\ to", escaped(scenario.description));
  for (const ControllerConfig& to : scenario.controllers) html += heading(to.name);
  html += '\n';
  std::map<std::string, std::size_t> reasons;  // how often each was given
  for (std::size_t from = 0; from < scenario.controllers.size(); ++from) {
    html += "<tr>" + heading(scenario.controllers[from].name);
    for (std::size_t to = 0; to < scenario.controllers.size(); ++to) {
      if (const PairHandover* one = worst(table, from, to)) {
        html += cell(*one, table);
      } else if (const PairRefusal* no = refusal(table, from, to)) {
        html += fmt::format("<td class=pair title=\"{}\"><span class=partly>refused</span>", escaped(no->reason));
      } else {
        html += from == to ? "<td class=pair>" : "<td class=pair>never held";
      }
    }
    html += '\n';
  }
  html += "</table></div>\n";
  for (const PairRefusal& one : table.refusals) ++reasons[one.reason];
  for (const auto& [reason, times] : reasons) {
    html += fmt::format("<p><span class=partly>refused</span> {} times: {}</p>\n", times, escaped(reason));
  }
  if (table.handovers.empty()) return html;
  const auto largest = [&](const auto& value) {
    double most = 0.0;
    for (const PairHandover& one : table.handovers) most = std::max(most, value(one));
    return most;
  };
  html += fmt::format(
      "<p>{} handovers. Largest at K: ratio {:.3f}; without the blend it would have been a step of {:.3g}. Over the "
      "blends: at most {:.0f} % of the rate limit, {:.3g} J put in, the force moves by {:.3g} N. The tip at K: up to "
      "{:.3g} m/s.</p>\n",
      table.handovers.size(), largest([](const auto& one) { return one.ratio(); }),
      largest([](const auto& one) { return one.without_blend.maxCoeff(); }),
      100.0 * largest([](const auto& one) { return one.rate_share; }),
      largest([](const auto& one) { return std::abs(one.blend_energy); }),
      largest([](const auto& one) { return one.force_deviation; }),
      largest([](const auto& one) { return one.tip_speed; }));
  return html;
}

}  // namespace baton
