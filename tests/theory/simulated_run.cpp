#include "simulated_run.hpp"

#include <cmath>
#include <stdexcept>

#include "robot/kinematics.hpp"
#include "runtime/monolithic_run.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

Trace emptyTrace(const Scenario& scenario) {
  Trace trace;
  trace.scenario = scenario;
  trace.is_complete = true;
  const Eigen::Index n = scenario.robot.size(), steps = static_cast<Eigen::Index>(scenario.end_step) + 1;
  for (Eigen::MatrixXd* joints : {&trace.q, &trace.qd, &trace.tau, &trace.q_d, &trace.qd_d, &trace.qdd_d})
    joints->resize(n, steps);
  for (Eigen::MatrixXd* three : {&trace.p_WE, &trace.p_WE_d, &trace.orientation, &trace.zyz, &trace.zyz_d})
    three->resize(3, steps);
  for (Eigen::MatrixXd* six : {&trace.V_WE_d, &trace.A_WE_d, &trace.h_d}) six->resize(6, steps);
  trace.h_e = Eigen::MatrixXd::Constant(6, steps, std::nan(""));
  trace.chain.resize(static_cast<std::size_t>(steps));
  return trace;
}

/// The step that the run has done last.
void fill(Trace& trace, Eigen::Index k, const MonolithicRun& run) {
  const RobotState& state = run.input().state;
  const Reference& reference = run.input().reference;
  trace.q.col(k) = state.q;
  trace.qd.col(k) = state.qd;
  trace.tau.col(k) = state.tau_applied;
  trace.q_d.col(k) = reference.q;
  trace.qd_d.col(k) = reference.qd;
  trace.qdd_d.col(k) = reference.qdd;
  trace.p_WE.col(k) = state.X_WE.p;
  trace.p_WE_d.col(k) = reference.X_WE.p;
  trace.orientation.col(k) = rotationVector(reference.X_WE.R * state.X_WE.R.transpose());
  trace.zyz.col(k) = zyzFromRotation(state.X_WE.R);
  trace.zyz_d.col(k) = zyzFromRotation(reference.X_WE.R);
  trace.V_WE_d.col(k) = reference.V_WE;
  trace.A_WE_d.col(k) = reference.A_WE;
  if (trace.scenario.hasEnvironment()) trace.h_e.col(k) = run.contact().h_e;
  trace.h_d.col(k) = reference.h_d;
}

}  // namespace

Scenario reportScenario(const std::string& name, const std::vector<TextChange>& changes) {
  const Scenario original = loadScenario((deployFolder() / "scenarios/report" / (name + ".yaml")).string());
  std::string text = original.text;
  for (const TextChange& change : changes) {
    const std::size_t at = text.find(change.from);
    if (at == std::string::npos || text.find(change.from, at + 1) != std::string::npos)
      throw std::runtime_error(name + ": expected '" + change.from + "' once");
    text.replace(at, change.from.size(), change.to);
  }
  return parseScenario(original.file, text, original.robot_file, original.robot_text);
}

Trace simulate(const Scenario& scenario) {
  Trace trace = emptyTrace(scenario);
  Scenario endless = scenario;
  endless.end_step = 0;  // what is recorded of the last step is all but the motion after it
  MonolithicRun run(endless);
  for (Eigen::Index k = 0; k < trace.steps(); ++k) {
    trace.chain[static_cast<std::size_t>(k)] = run.chainHash();
    if (!run.step() || !run.failovers().empty()) throw std::runtime_error(scenario.name + ": " + run.whatWentWrong());
    fill(trace, k, run);
  }
  return trace;
}

}  // namespace baton::test
