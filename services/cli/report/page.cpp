#include "page.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

#include "base/error.hpp"
#include "base/plural.hpp"
#include "html.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The report's figures, run again</title>
<style>
  body { font: 15px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
  h2 { margin: 2.5rem 0 0.3rem; border-top: 1px solid #ddd; padding-top: 1.2rem; font-size: 1.15rem; }
  table { border-collapse: collapse; margin: 0.6rem 0; font-size: 0.92rem; }
  th, td { text-align: left; padding: 0.2rem 0.9rem 0.2rem 0; vertical-align: top; border-bottom: 1px solid #eee; }
  td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; font-family: ui-monospace, monospace; }
  dl { display: grid; grid-template-columns: 9rem 1fr; gap: 0.2rem 0.8rem; margin: 0.4rem 0; }
  dt { color: #666; } dd { margin: 0; }
  img { max-width: 100%; height: auto; }
  .wide { overflow-x: auto; } .wide th { font-size: 0.8rem; } td.pair { text-align: center; padding: 0.15rem 0.4rem; }
  .holds, .agrees { color: #1d7a3c; } .partly { color: #9a6a00; } .wrong, .differs { color: #b3261e; }
  .tag { font-weight: 600; white-space: nowrap; }
  @media (prefers-color-scheme: dark) {
    body { background: #16181b; color: #ddd; } img { background: #fff; border-radius: 4px; }
    h2 { border-color: #333; } th, td { border-color: #2a2d31; } dt { color: #999; } a { color: #8ab4f8; }
    .holds, .agrees { color: #6fce8b; } .partly { color: #e0b04d; } .wrong, .differs { color: #ff8a80; }
  }
</style>
)";

constexpr const char* kIntroduction = R"(<h1>The report's figures, run again</h1>
<p>Each figure below comes from a recording of the distributed system: plant, wall, trajectory and controller as
processes of their own on DDS, in lockstep. <em>Our runs</em> says whether what was measured agrees with what theory
predicts, number by number. Only where it does is the report's claim judged: it <em>holds</em> when all that it says
was measured so, <em>holds in part</em> when some of it was and the rest was not, and <em>is wrong</em> when none of
it was.</p>
<p>Predictions are made from the scenario and without the recorded motion: in closed form; as a balance at rest, solved by
Newton's iteration (of several false rests, the one that the run is at); or by integrating the continuous equation of arm,
law and wall with steps of its own. What describes the arm, B, C, g and Y, are the same functions on both sides; tests
hold them against Newton-Euler and orocos-kdl.</p>
)";

constexpr const char* kSymbols =
    R"(<p>The arm has one revolute joint (q1, rad) and two prismatic ones (q2, q3, m); L is how far its third link is out.
A prime is a derivative by time, q' and q''; what is quoted from the report has its qd and qdd. q_d, x_d: desired joint positions and tip pose; e = q_d - q; x~ = x_d - x.
q_r' = q_d' + lam e: the velocity that adaptive control wants; Th: its estimate of the dynamic parameters, Y: the matrix
that makes torques of them. tau: joint torques and forces. B, n: the arm's inertia matrix, and its Coriolis, centrifugal
and gravity terms C q' + g together. J_P, J_A: Jacobian of the tip's position, and of position and ZYZ angles (phi, theta,
psi). h_e: force and moment of the tip on the wall, f_e its force; f_d: the desired force; Ke: the wall's stiffness; z_r:
where it stands. Kp, Kd, Ki: gains on error, velocity and integral, in the units that make a torque (joint and operational
PD, compliance), a force (impedance, admittance) or an acceleration (inverse dynamics) of them. Md, Mt: masses that
impedance and admittance control give the tip; z, in admittance: how far the tip gives way. x_F: the position that force
control asks for, alone in Figures 49 to 51, as an addition to x_d in 53 and 54; x_e: where the tip is.
<em>Held</em>, <em>late</em> and <em>derivatives</em>, of a force: kept over a step; kept from the step before; told with
its slopes over position and velocity, so that it follows the motion within the step.</p>
<p>The report prints no masses and inertias; those used here are identified from the digits of B, g and tau that it
does print, with the double count in its B11 (see its errors, below). That these digits come out again proves nothing; motions, forces and steady states do. The tolerance of
a number at rest is 1e-4 of it, or 1e-6 where theory says zero; on the way it covers what the step of the run is
known to cost.</p>
)";

constexpr const char* kStudiesHead = R"(<h2 id='studies'>Beyond the report</h2>
<p>Questions of our own. Each starts from recordings of the distributed system, like the figures above; charts are
computed by running the same scenario again in one process, many times over, with a number varied.</p>
)";

const char* className(ClaimVerdict verdict) {
  switch (verdict) {
    case ClaimVerdict::kHolds: return "holds";
    case ClaimVerdict::kPartly: return "partly";
    case ClaimVerdict::kWrong: return "wrong";
    case ClaimVerdict::kNone: return "none";
    case ClaimVerdict::kNotEstablished: return "differs";
  }
  return "";
}

std::string anchorOf(const Figure& figure) {
  std::string anchor = "figure-";
  for (const char c : figure.number) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      anchor += c;
    else if (anchor.back() != '-')
      anchor += '-';
  }
  return anchor;
}

std::string agreement(const FigureResult& result) {
  if (!result.failure.empty()) return "<span class='tag partly'>not completed</span>";
  return result.agrees() ? "<span class='tag agrees'>agrees with theory</span>"
                         : "<span class='tag differs'>differs from theory</span>";
}

std::string verdictTag(const FigureResult& result) {
  return fmt::format("<span class='tag {}'>{}</span>", className(result.verdict()), toString(result.verdict()));
}

void writeSummary(std::ostream& page, const std::vector<FigureResult>& results) {
  page << "<table><tr><th>figure<th><th>the report's claim<th>our runs\n";
  for (const FigureResult& result : results) {
    page << fmt::format("<tr><td><a href='#{}'>{}</a><td>{}<td>{}<td>{}\n", anchorOf(result.figure),
                        escaped(result.figure.number), escaped(result.figure.title),
                        result.figure.is_study ? "beyond the report" : verdictTag(result), agreement(result));
  }
  page << "</table>\n";
}

void writeChecks(std::ostream& page, const std::vector<Check>& checks) {
  if (checks.empty()) return;
  page << "<table><tr><th>quantity<th class=number>predicted<th class=number>measured<th class=number>difference"
          "<th class=number>allowed<th>\n";
  for (const Check& check : checks) {
    const double difference = check.measured - check.predicted;
    const double shown = check.is_relative ? difference / check.predicted : difference;
    page << fmt::format(
        "<tr><td>{}{}<td class=number>{:.9g}<td class=number>{:.9g}<td class=number>{:.2g}{}<td "
        "class=number>{:.2g}{}<td>{}\n",
        escaped(check.what), check.unit.empty() ? "" : " [" + escaped(check.unit) + "]", check.predicted,
        check.measured, shown, check.is_relative ? " rel" : "", check.tolerance, check.is_relative ? " rel" : "",
        check.passes() ? "<span class=agrees>ok</span>" : "<span class='tag differs'>off</span>");
  }
  page << "</table>\n";
}

void writeFigure(std::ostream& page, const FigureResult& result) {
  const Figure& figure = result.figure;
  page << fmt::format("<h2 id='{}'>{}{}: {}</h2>\n", anchorOf(figure),
                      std::isdigit(static_cast<unsigned char>(figure.number.front())) != 0 ? "Figure " : "",
                      escaped(figure.number), escaped(figure.title));
  page << "<dl>\n";
  page << fmt::format("<dt>{}<dd>{}\n", figure.is_study ? "question" : "the report says", escaped(figure.claim));
  page << fmt::format("<dt>theory predicts<dd>{}\n", escaped(figure.theory));
  page << fmt::format("<dt>finding<dd>{} {}\n", figure.is_study ? "" : verdictTag(result),
                      result.agrees()          ? escaped(figure.finding)
                      : result.failure.empty() ? "Our runs do not agree with theory here."
                                               : "Something could not be run, measured or drawn.");
  std::string runs;
  for (std::size_t i = 0; i < figure.runs.size(); ++i) {
    runs += fmt::format("{}<code>baton run {}/{}</code>", runs.empty() ? "" : "<br>", escaped(figure.folder),
                        escaped(figure.runs[i].scenario));
    if (i < result.settings.size()) runs += fmt::format(" <small>{}</small>", escaped(result.settings[i]));
  }
  page << fmt::format("<dt>{}<dd>{}\n</dl>\n", figure.runs.size() == 1 ? "scenario" : "scenarios", runs);
  page << "<p>" << agreement(result) << "</p>\n";
  if (!result.failure.empty()) page << fmt::format("<pre>{}</pre>\n", escaped(result.failure));
  writeChecks(page, result.checks);
  for (const std::string& table : result.tables) page << table;
  for (const std::string& drawing : result.drawings) {
    page << fmt::format("<p><a href='{0}.png'><img src='{0}.svg' alt='{1}' loading=lazy></a></p>\n", escaped(drawing),
                        escaped(figure.title));
  }
}

/// What this page's runs make of an erratum; it rests on the figures that it names.
std::string standing(const Erratum& erratum, const std::vector<FigureResult>& results) {
  if (erratum.figures.empty()) return "no figure";
  bool is_established = true;
  for (const std::string& name : erratum.figures) {
    const auto found =
        std::find_if(results.begin(), results.end(), [&](const auto& one) { return one.figure.number == name; });
    if (found == results.end()) return "not run";
    is_established = is_established && found->agrees();
  }
  if (is_established && erratum.printed_cannot_run) return "<span class=agrees>what is right agrees with theory</span>";
  return is_established ? "<span class=agrees>established</span>" : "<span class='tag differs'>not established</span>";
}

void writeErrata(std::ostream& page, const std::vector<Erratum>& errata, const std::vector<FigureResult>& results) {
  page << "<h2 id='errata'>What the report has wrong</h2>\n"
          "<p><em>Established</em>: both sides were run or measured in the figures named, and all their numbers agree. "
          "<em>What is right agrees with theory:</em> what is printed was not run, what is right was. <em>No "
          "figure</em>: "
          "the evidence is a test, or reading.</p>\n"
          "<table><tr><th>where<th>printed<th>right<th>evidence<th>our runs\n";
  for (const Erratum& erratum : errata) {
    page << fmt::format("<tr><td>{}<td>{}<td>{}<td>{}<td>{}\n", escaped(erratum.where), escaped(erratum.printed),
                        escaped(erratum.right), escaped(erratum.evidence), standing(erratum, results));
  }
  page << "</table>\n";
}

}  // namespace

bool FigureResult::agrees() const {
  return failure.empty() && !checks.empty() &&
         std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.passes(); });
}

const char* toString(ClaimVerdict verdict) {
  switch (verdict) {
    case ClaimVerdict::kHolds: return "holds";
    case ClaimVerdict::kPartly: return "holds in part";
    case ClaimVerdict::kWrong: return "is wrong";
    case ClaimVerdict::kNone: return "nothing is claimed";
    case ClaimVerdict::kNotEstablished: return "not established";
  }
  return "?";
}

void writePage(const std::filesystem::path& file, const std::vector<FigureResult>& results,
               const std::vector<Erratum>& errata, const PageFacts& facts) {
  std::ostringstream page;
  page << kHead;
  page << kIntroduction << kSymbols;
  page << fmt::format("<p>{}, {} of them reused from before; {:.0f} s. Made by {}.</p>\n", counted(facts.runs, "run"),
                      facts.reused, facts.elapsed_s, escaped(facts.build));
  writeSummary(page, results);
  const auto writeAll = [&](bool studies) {
    for (const FigureResult& result : results) {
      if (result.figure.is_study == studies) writeFigure(page, result);
    }
  };
  writeAll(false);
  writeErrata(page, errata, results);
  if (std::any_of(results.begin(), results.end(), [](const auto& result) { return result.figure.is_study; })) {
    page << kStudiesHead;
    writeAll(true);
  }
  page << "</html>\n";
  writeFile(file, page.str());
}

}  // namespace baton
