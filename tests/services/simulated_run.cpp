#include "simulated_run.hpp"

#include <stdexcept>

#include "control/arm.hpp"
#include "control/law.hpp"
#include "environment/plane.hpp"
#include "robot/kinematics.hpp"
#include "support/processes.hpp"

namespace baton::test {
namespace {

Trace emptyTrace(const Scenario& scenario) {
  Trace trace;
  trace.scenario = scenario;
  trace.is_complete = true;
  const Eigen::Index n = scenario.robot.size(), steps = static_cast<Eigen::Index>(scenario.end_step) + 1;
  for (Eigen::MatrixXd* joints :
       {&trace.q, &trace.qd, &trace.tau, &trace.command, &trace.q_d, &trace.qd_d, &trace.qdd_d})
    joints->resize(n, steps);
  for (Eigen::MatrixXd* three : {&trace.p_WE, &trace.p_WE_d, &trace.orientation, &trace.zyz, &trace.zyz_d})
    three->resize(3, steps);
  trace.h_e.resize(6, steps);
  trace.h_d.resize(6, steps);
  trace.holders.assign(static_cast<std::size_t>(steps), scenario.active);
  return trace;
}

void fill(Trace& trace, Eigen::Index k, const LawInput& input, const JointVector& command) {
  const RobotState& state = input.state;
  const Reference& reference = input.reference;
  trace.q.col(k) = state.q;
  trace.qd.col(k) = state.qd;
  trace.tau.col(k) = state.tau_applied;
  trace.command.col(k) = command;
  trace.q_d.col(k) = reference.q;
  trace.qd_d.col(k) = reference.qd;
  trace.qdd_d.col(k) = reference.qdd;
  trace.p_WE.col(k) = state.X_WE.p;
  trace.p_WE_d.col(k) = reference.X_WE.p;
  trace.orientation.col(k) = rotationVector(reference.X_WE.R * state.X_WE.R.transpose());
  trace.zyz.col(k) = zyzFromRotation(state.X_WE.R);
  trace.zyz_d.col(k) = zyzFromRotation(reference.X_WE.R);
  trace.h_e.col(k) = input.contact.h_e;
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
  Arm arm(trace.scenario.robot, trace.scenario.armConfig());
  const Trajectory trajectory(scenario.robot, scenario.trajectory);
  const ControllerConfig& holder = scenario.controller(scenario.active);
  const auto law = makeLaw(holder.law, scenario.robot, holder.parameters);
  law->reset();
  LawInput input;
  input.dt_s = scenario.stepSeconds();
  JointVector command;
  for (Eigen::Index k = 0; k < trace.steps(); ++k) {
    input.state = arm.state();
    input.contact = planesContact(scenario.walls, input.state.X_WE.p, input.state.V_WE.head<3>());
    trajectory.evaluate(trace.time(k), input.reference);
    if (law->step(input, command) != LawStatus::kOk || !arm.move(command, input.contact))
      throw std::runtime_error(scenario.name + " fails at step " + std::to_string(k));
    fill(trace, k, input, command);
  }
  return trace;
}

}  // namespace baton::test
