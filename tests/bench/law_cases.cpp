#include <memory>
#include <random>
#include <stdexcept>

#include "bench/cases.hpp"
#include "control/law.hpp"
#include "robot/kinematics.hpp"
#include "support/robots.hpp"

namespace baton::bench {
namespace {

/// An arm on its way to a reference near by, in contact.
LawInput randomInput(const RobotModel& model, std::mt19937& generator) {
  const int n = model.size();
  Kinematics actual, wanted;
  LawInput input;
  input.dt_s = 5e-4;
  input.state.q = test::randomJointVector(generator, n, 0.5);
  input.state.qd = test::randomJointVector(generator, n, 1.0);
  input.state.tau_applied = JointVector::Zero(n);
  computeKinematics(model, input.state.q, input.state.qd, actual);
  input.state.X_WE = actual.X_WE;
  input.state.V_WE = actual.V_WE;
  input.contact.h_e.head<3>() = test::randomJointVector(generator, 3, 5.0);

  Reference& reference = input.reference;
  reference.q = input.state.q + test::randomJointVector(generator, n, 0.1);
  reference.qd = test::randomJointVector(generator, n, 1.0);
  reference.qdd = test::randomJointVector(generator, n, 1.0);
  computeKinematics(model, reference.q, reference.qd, wanted);
  reference.has_task = true;
  reference.X_WE = wanted.X_WE;
  reference.V_WE = wanted.V_WE;
  reference.A_WE = wanted.J * reference.qdd + wanted.Jdot_qd;
  reference.h_d.head<3>() = test::randomJointVector(generator, 3, 5.0);
  return input;
}

/// A law and what it is fed. The effort it asks for comes back as the one that was applied, as no joint is at a limit.
struct RunningLaw {
  std::unique_ptr<Law> law;
  std::vector<LawInput> inputs;
  JointVector tau;

  RunningLaw(const LawInfo& info, const RobotModel& model)
      : law(makeLaw(info.name, model, {})), tau(JointVector::Zero(model.size())) {
    std::mt19937 generator(1);
    for (int k = 0; k < kStates; ++k) inputs.push_back(randomInput(model, generator));
    law->reset();
  }

  LawStatus hold(int k) noexcept {
    inputs[k].state.tau_applied = tau;
    return law->step(inputs[k], tau);
  }

  LawStatus standBy(int k) noexcept {
    inputs[k].state.tau_applied = tau;
    law->handover(inputs[k]);
    return law->step(inputs[k], tau);
  }
};

}  // namespace

void addLaws() {
  for (const auto& [arm, model] : arms()) {
    for (const LawInfo& info : allLaws()) {
      const auto holding = std::make_shared<RunningLaw>(info, model),
                 waiting = std::make_shared<RunningLaw>(info, model);
      for (int k = 0; k < kStates; ++k) {
        for (const LawStatus status : {holding->hold(k), waiting->standBy(k)}) {
          if (status != LawStatus::kOk)
            throw std::runtime_error(info.name + " refuses a step of the " + arm + ": " + toString(status));
        }
      }
      const std::string name = arm + "/" + info.name;
      addCase(name + "/Baton", [holding](int k) { return holding->hold(k); });
      addCase(name + ", standing by/Baton", [waiting](int k) { return waiting->standBy(k); });
    }
  }
}

}  // namespace baton::bench
