#include "model_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "runtime/paths.hpp"
#include "runtime/say.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

struct ModelRequest {
  std::string robot;
  std::vector<std::string> q, qd, qdd, wrench;  // as typed
  bool json = false;
};

/// Everything there is to say of a robot at (q, qd, qdd, h_e).
struct ModelReport {
  RobotModel robot;
  JointVector q, qd, qdd;
  Vector6 h_e;
  Kinematics kinematics;
  Vector3 zyz;
  std::optional<Jacobian> J_A;  // nothing where the ZYZ angles are singular
  LagrangeTerms terms;
  JointVector friction;
  JointVector tau_newton_euler;  // B qdd + C qd + g + friction + J^T h_e
  JointVector tau_lagrange;
};

/// The numbers of an option, written as in the files: "pi/6" is one; each a word of its own, or all one word with
/// commas. All zero when the option was not given.
Eigen::VectorXd parseNumbers(const std::string& option, const std::vector<std::string>& words, int size,
                             const std::string& each) {
  if (words.empty()) return Eigen::VectorXd::Zero(size);
  const auto count = static_cast<std::size_t>(size);
  const std::string given = fmt::format("{}", fmt::join(words, " "));
  const auto commas = std::ranges::count(given, ',');
  const std::size_t found = words.size() > 1 ? words.size() : static_cast<std::size_t>(commas) + 1;
  if (found != count || (words.size() > 1 && commas > 0)) {
    throw UsageError(
        fmt::format("{}: expected {} numbers, one per {}, with spaces or with commas between them, found "
                    "{}: {}{}",
                    option, size, each, found, given, commas > 0 ? "; the decimal sign is a point" : ""));
  }
  const std::string list = fmt::format("[{}]", fmt::join(words, ", "));
  const std::vector<double> values = YamlNode::parse(option, list).numbers(count, {}, each);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
}

ModelReport evaluate(const ModelRequest& request) {
  ModelReport report;
  std::vector<std::string> warnings;
  report.robot = loadRobot(findRobot(request.robot), &warnings);
  for (const std::string& warning : warnings) sayWarning(warning);
  const RobotModel& robot = report.robot;
  report.q = parseNumbers("--q", request.q, robot.size(), "joint");
  report.qd = parseNumbers("--qd", request.qd, robot.size(), "joint");
  report.qdd = parseNumbers("--qdd", request.qdd, robot.size(), "joint");
  report.h_e = parseNumbers("--wrench", request.wrench, 6, "component");

  computeKinematics(robot, report.q, report.qd, report.kinematics);
  report.zyz = zyzFromRotation(report.kinematics.X_WE.R);
  if (Jacobian J_A; analyticalJacobian(report.kinematics, J_A)) report.J_A = J_A;
  lagrangeDynamics(robot, report.q, report.qd, report.terms);
  frictionEffort(robot, report.qd, report.friction);
  inverseDynamics(robot, report.q, report.qd, report.qdd, report.h_e, report.tau_newton_euler);
  report.tau_newton_euler += report.friction;
  report.tau_lagrange = report.terms.B * report.qdd + report.terms.C * report.qd + report.terms.g + report.friction +
                        report.kinematics.J.transpose() * report.h_e;
  return report;
}

// --- text
// -------------------------------------------------------------------------------------------------------------

/// One line a row, behind `name` and the unit.
template <class Derived>
void print(const std::string& name, const Eigen::MatrixBase<Derived>& matrix, const std::string& unit = "") {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    std::string line = fmt::format("{:<24}", i == 0 ? name : "");
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      line += fmt::format(" {:>14.8g}", matrix(i, j) == 0.0 ? 0.0 : matrix(i, j));  // no -0
    }
    if (i == 0 && !unit.empty()) line += "  " + unit;
    sayText(line + '\n');
  }
}

void printText(const ModelReport& report) {
  std::string joints;
  for (const Joint& joint : report.robot.joints) {
    joints += fmt::format("{}{} ({})", joints.empty() ? "" : ", ", joint.name,
                          joint.kind == JointKind::kRevolute ? "rad, N m" : "m, N");
  }
  say("%s: %s\n", report.robot.name.c_str(), joints.c_str());
  print("q", report.q.transpose());
  print("qd", report.qd.transpose(), "per s");
  print("qdd", report.qdd.transpose(), "per s^2");
  print("wrench h_e", report.h_e.transpose(), "N; N m");
  say("\ntip\n");
  print("position p", report.kinematics.X_WE.p.transpose(), "m");
  print("rotation R", report.kinematics.X_WE.R);
  print("ZYZ angles", report.zyz.transpose(), "rad");
  print("geometric Jacobian J", report.kinematics.J);
  if (report.J_A) {
    print("analytical Jacobian J_A", *report.J_A);
  } else {
    say("analytical Jacobian J_A  does not exist here: the ZYZ angles are singular at sin(theta) = 0\n");
  }
  say("\nB qdd + C qd + g + friction + J^T h_e = tau\n");
  print("B", report.terms.B);
  print("C", report.terms.C);
  print("g", report.terms.g.transpose());
  print("friction", report.friction.transpose());
  print("tau, Newton-Euler", report.tau_newton_euler.transpose());
  print("tau, Lagrange", report.tau_lagrange.transpose());
  print("difference", (report.tau_newton_euler - report.tau_lagrange).transpose());
}

// --- JSON
// -------------------------------------------------------------------------------------------------------------

template <class Derived>
nlohmann::ordered_json vectorJson(const Eigen::MatrixBase<Derived>& vector) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) json.push_back(vector(i));
  return json;
}

/// A list of rows.
template <class Derived>
nlohmann::ordered_json matrixJson(const Eigen::MatrixBase<Derived>& matrix) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) json.push_back(vectorJson(matrix.row(i)));
  return json;
}

nlohmann::ordered_json toJson(const ModelReport& report) {
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  for (const Joint& joint : report.robot.joints) {
    joints.push_back({{"name", joint.name}, {"kind", joint.kind == JointKind::kRevolute ? "revolute" : "prismatic"}});
  }
  return {{"robot", report.robot.name},
          {"joints", joints},
          {"q", vectorJson(report.q)},
          {"qd", vectorJson(report.qd)},
          {"qdd", vectorJson(report.qdd)},
          {"wrench", vectorJson(report.h_e)},
          {"p_WE_m", vectorJson(report.kinematics.X_WE.p)},
          {"R_WE", matrixJson(report.kinematics.X_WE.R)},
          {"zyz_rad", vectorJson(report.zyz)},
          {"J", matrixJson(report.kinematics.J)},
          {"J_A", report.J_A ? matrixJson(*report.J_A) : nlohmann::ordered_json(nullptr)},
          {"B", matrixJson(report.terms.B)},
          {"C", matrixJson(report.terms.C)},
          {"g", vectorJson(report.terms.g)},
          {"friction", vectorJson(report.friction)},
          {"tau_newton_euler", vectorJson(report.tau_newton_euler)},
          {"tau_lagrange", vectorJson(report.tau_lagrange)},
          {"tau_difference", vectorJson(report.tau_newton_euler - report.tau_lagrange)}};
}

}  // namespace

void addModelCommand(CLI::App& app, ExitCode& /*exit_code*/) {
  const auto request = std::make_shared<ModelRequest>();
  CLI::App* command = app.add_subcommand("model", "kinematics and dynamics of a robot at one configuration");
  command->footer(
      "Numbers may be multiples of pi. One that begins with -pi needs the short form: --q=-pi/6,0.2,0.1\n"
      "SI units; by joint kind rad and N m, or m and N. Twists and wrenches are [linear; angular], of the tip, in the\n"
      "world frame. tau = B qdd + C qd + g + friction + J^T h_e, h_e the wrench the tip exerts on the environment.\n"
      "Keys of --json (matrices are lists of rows, numbers have full precision): robot; joints: name, kind; q, qd,\n"
      "qdd, wrench: as given; p_WE_m, R_WE, zyz_rad: pose of the tip in the world, its ZYZ angles; J, J_A:\n"
      "geometric and analytical Jacobian, 6 x n, J_A null where the ZYZ angles are singular; B, C, g: by Lagrange;\n"
      "friction; tau_newton_euler, tau_lagrange: tau by either road; tau_difference: the first minus the second.");
  const auto add = [&](const std::string& name, std::vector<std::string>& words, const std::string& help) {
    return command->add_option(name, words, help);
  };
  command->add_option("--robot", request->robot, "robot file, or the name of one that comes with Baton")->required();
  add("--q", request->q, "joint positions, one per joint [rad or m]")->required();
  add("--qd", request->qd, "joint velocities [rad/s or m/s] (default: 0)");
  add("--qdd", request->qdd, "joint accelerations [rad/s^2 or m/s^2] (default: 0)");
  add("--wrench", request->wrench, "fx fy fz mx my mz that the tip exerts on the environment [N; N m] (default: 0)");
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request] {
    const ModelReport report = evaluate(*request);
    if (request->json) {
      sayText(escapedInJson(toJson(report).dump()) + '\n');
    } else {
      printText(report);
    }
  });
}

}  // namespace baton
