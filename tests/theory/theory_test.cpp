// What theory says of a run must be able to be wrong. Each check is given a run as it should be, which it must pass,
// and the same run off by little more than its tolerance, which it must not.
#include "report/theory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <set>
#include <stdexcept>

#include "simulated_run.hpp"

namespace baton::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Traces = std::vector<Trace>;
using Checks = std::vector<Check>;
using Signal = Eigen::MatrixXd Trace::*;

/// A way in which runs may be off. `good` is what the check says of them as they should be.
struct Fault {
  std::string what;
  std::function<void(Traces& runs, const Checks& good)> put;
};

struct Experiment {
  std::string scenario;
  std::vector<TextChange> changes;  // shorter than the report's, where theory holds from early on
};

struct Case {
  std::string check;
  std::vector<Experiment> runs;  // two for a check that compares
  std::vector<Fault> faults;     // together they spoil every number that the check gives
  // NOLINTNEXTLINE(readability-identifier-naming): the name GoogleTest looks for
  friend void PrintTo(const Case& one, std::ostream* out) { *out << one.check; }
};

double allowed(const Check& check) { return check.tolerance * (check.is_relative ? std::abs(check.predicted) : 1.0); }

/// The first check whose name begins like this.
const Check& named(const Checks& checks, const std::string& beginning) {
  for (const Check& check : checks) {
    if (check.what.starts_with(beginning)) return check;
  }
  throw std::runtime_error("no check '" + beginning + "'");
}

// --- faults

constexpr double kBeyond = 2.0;  // tolerances by which a fault is off

enum class When { kThroughout, kOnce, kAtTheEnd };

/// Row i of a signal is off by twice what the i-th of these checks allows; "" leaves the row alone.
Fault off(Signal signal, const std::vector<std::string>& checks, When when) {
  return {checks.back(), [=](Traces& runs, const Checks& good) {
            Eigen::MatrixXd& matrix = runs[0].*signal;
            const Eigen::Index steps = matrix.cols();
            const Eigen::Index begin = when == When::kThroughout ? 0
                                       : when == When::kOnce     ? 3 * steps / 4
                                                                 : 19 * steps / 20;
            const Eigen::Index count = when == When::kOnce ? 1 : steps - begin;
            for (std::size_t i = 0; i < checks.size(); ++i) {
              if (checks[i].empty()) continue;
              matrix.row(static_cast<Eigen::Index>(i)).segment(begin, count).array() +=
                  kBeyond * allowed(named(good, checks[i]));
            }
          }};
}

Fault jointsOffAtTheEnd() { return off(&Trace::q, {"error of q1", "error of q2", "error of q3"}, When::kAtTheEnd); }
Fault tipOffAtTheEnd() { return off(&Trace::p_WE, {"error of x", "error of y", "error of z"}, When::kAtTheEnd); }
Fault forceOffAtTheEnd() { return off(&Trace::h_e, {"", "", "force on the wall"}, When::kAtTheEnd); }

/// The errors of one run's joints are larger, all by the part of them that the check allows twice over.
Fault largerErrors(std::size_t run, const std::string& check) {
  return {check, [=](Traces& runs, const Checks& good) {
            Trace& trace = runs[run];
            trace.q = trace.q_d - (1.0 + kBeyond * named(good, check).tolerance) * (trace.q_d - trace.q);
          }};
}

/// The same about the goal, which noise on q_d leaves where it is.
Fault largerAboutTheGoal(std::size_t run, const std::string& check) {
  return {check, [=](Traces& runs, const Checks& good) {
            Trace& trace = runs[run];
            const JointVector goal = std::get<JointPath>(trace.scenario.trajectory.motion).waypoints.back().q;
            const double factor = 1.0 + kBeyond * named(good, check).tolerance;
            trace.q = (factor * (trace.q.colwise() - Eigen::VectorXd(goal))).colwise() + Eigen::VectorXd(goal);
          }};
}

/// The run of a scenario that differs a little, taken for the run of this one.
Fault mistaken(const Experiment& run, const TextChange& change) {
  return {"'" + change.from + "' run as '" + change.to + "'", [=](Traces& runs, const Checks&) {
            std::vector<TextChange> changes = run.changes;
            changes.push_back(change);
            const Scenario scenario = runs[0].scenario;
            runs[0] = simulate(reportScenario(run.scenario, changes));
            runs[0].scenario = scenario;
          }};
}

/// The largest value of a row of a signal, seen from zero, is larger.
Fault higherPeak(Signal signal, Eigen::Index row, const std::string& check) {
  return {check, [=](Traces& runs, const Checks& good) {
            Eigen::Index peak = 0;
            (runs[0].*signal).row(row).cwiseAbs().maxCoeff(&peak);
            double& value = (runs[0].*signal)(row, peak);
            value += std::copysign(kBeyond * allowed(named(good, check)), value);
          }};
}

Fault aTouch() {
  return {"a touch", [](Traces& runs, const Checks&) { runs[0].h_e(2, runs[0].steps() / 2) = 1e-12; }};
}

Fault oneBitOff() {
  return {"a bit of one step", [](Traces& runs, const Checks&) { runs[0].chain[runs[0].chain.size() / 2] ^= 1; }};
}

Fault largestErrorLarger() {
  return {"largest error on the way", [](Traces& runs, const Checks& good) {
            Trace& trace = runs[0];
            for (Eigen::Index i = 0; i < trace.q.rows(); ++i) {
              const std::string check = "largest error of q" + std::to_string(i + 1);
              const Eigen::RowVectorXd error = trace.q_d.row(i) - trace.q.row(i);
              Eigen::Index peak = 0;
              error.cwiseAbs().maxCoeff(&peak);
              trace.q(i, peak) -= std::copysign(kBeyond * allowed(named(good, check)), error(peak));
            }
          }};
}

Fault otherDecay() {
  return {"another rate", [](Traces& runs, const Checks& good) {
            Trace& trace = runs[0];
            for (Eigen::Index i = 0; i < trace.q.rows(); ++i) {
              for (Eigen::Index k = 0; k < trace.steps(); ++k) {
                const double factor = std::exp(-kBeyond * allowed(good[static_cast<std::size_t>(i)]) * trace.time(k));
                trace.q(i, k) = trace.q_d(i, k) - factor * (trace.q_d(i, k) - trace.q(i, k));
              }
            }
          }};
}

Fault otherEffort(const std::string& what, Eigen::Index step) {
  return {what, [=](Traces& runs, const Checks& good) {
            runs[0].tau.col(step) = (1.0 + kBeyond * named(good, what).tolerance) * runs[0].tau.col(1);
          }};
}

Fault longerAtTheLimit() {
  return {"time at the limit", [](Traces& runs, const Checks& good) {
            Trace& trace = runs[0];
            const double time_s = kBeyond * allowed(named(good, "time of q1 at its limit"));
            const auto steps = static_cast<Eigen::Index>(std::lround(time_s / trace.scenario.stepSeconds()));
            for (Eigen::Index i = 0; i < trace.tau.rows(); ++i) {
              const double limit = trace.scenario.robot.joints[static_cast<std::size_t>(i)].effort_limit;
              trace.tau.row(i).tail(steps).setConstant(limit);
            }
          }};
}

Fault longerOnTheWay() {
  return {"time to settle", [](Traces& runs, const Checks& good) {
            Trace& trace = runs[0];
            const JointVector goal = trace.q_d.rightCols(1);
            for (Eigen::Index i = 0; i < trace.q.rows(); ++i) {
              const Check& check = named(good, "time in which q" + std::to_string(i + 1));
              const double until_s = check.measured + kBeyond * allowed(check);
              const auto step = static_cast<Eigen::Index>(std::lround(until_s / trace.scenario.stepSeconds()));
              trace.q(i, step - 1) = goal(i) - 0.03 * (goal(i) - trace.scenario.start_q(i));
            }
          }};
}

Fault tipFartherFromItsGoal() {
  return {"distance of the tip", [](Traces& runs, const Checks& good) {
            Trace& trace = runs[0];
            const Vector3 away = trace.p_WE.col(trace.last() - 1) - trace.p_WE_d.col(trace.last() - 1);
            trace.p_WE.colwise() += Eigen::VectorXd(kBeyond * allowed(named(good, "distance")) * away.normalized());
          }};
}

// --- faults of a run through the jump of the ZYZ angles

/// The step before phi jumps, the first time.
Eigen::Index jumpOf(const Trace& trace) {
  Eigen::Index k = 0;
  while (std::abs(std::remainder(trace.zyz(0, k + 1) - trace.zyz(0, k), 2.0 * kPi)) < kPi / 2.0) ++k;
  return k;
}

Fault anotherJump() {
  return {"a jump that is none of q1's",
          [](Traces& runs, const Checks&) { runs[0].zyz.row(0).tail(10).array() += kPi; }};
}

Fault noJump() {
  return {"one jump less", [](Traces& runs, const Checks&) {
            Eigen::MatrixXd& zyz = runs[0].zyz;
            const Eigen::Index k = jumpOf(runs[0]);
            zyz.leftCols(k + 1).colwise() = Eigen::VectorXd(zyz.col(k + 1));
          }};
}

Fault otherJump(Eigen::Index angle, const std::string& check) {
  return {check, [=](Traces& runs, const Checks& good) {
            runs[0].zyz(angle, jumpOf(runs[0]) + 1) += kBeyond * allowed(named(good, check));
          }};
}

Fault thetaMoves() {
  return {"theta", [](Traces& runs, const Checks& good) {
            Eigen::MatrixXd& zyz = runs[0].zyz;
            const Eigen::Index k = jumpOf(runs[0]);
            zyz(1, k + 1) = zyz(1, k) + kBeyond * allowed(named(good, "change of theta"));
          }};
}

// --- the cases

const Experiment kJointPd{"fig03_joint_pd", {}};
const Experiment kNoGravity{"fig04_joint_pd_no_gravity", {{"duration_s: 15", "duration_s: 11"}}};
const Experiment kNoisyPd{"fig05_noise_joint_pd", {{"duration_s: 60", "duration_s: 12"}}};
const Experiment kNoisyInverseDynamics{"fig05_noise_inverse_dynamics", {{"duration_s: 60", "duration_s: 12"}}};
const Experiment kInverseDynamics{"fig09_inverse_dynamics", {}};
const Experiment kTipTracking{"fig24_operational_tracking", {{"duration_s: 8", "duration_s: 6"}}};
const Experiment kWrongMasses{"fig10_wrong_masses", {}};
const Experiment kNoInertia{"fig11_no_inertia", {{"duration_s: 10", "duration_s: 8"}}};
const Experiment kNoBias{"fig12_no_bias", {}};
const Experiment kNoCompensation{"fig13_no_compensation", {}};
const Experiment kHighGain{"fig14_high_gain", {{"duration_s: 5", "duration_s: 0.1"}}};
const Experiment kSaturated{"fig14_saturated", {{"duration_s: 5", "duration_s: 2"}}};
const Experiment kAdaptive{"fig16_adaptive", {{"duration_s: 20", "duration_s: 0.5"}}};
const Experiment kAdaptationOff{"fig16_adaptation_off", {{"duration_s: 20", "duration_s: 0.5"}}};
const Experiment kTuned{"fig16_tuned", {{"duration_s: 20", "duration_s: 5"}}};
const Experiment kFreeCompliance{"fig33_compliance_free", {{"duration_s: 10", "duration_s: 7"}}};
const Experiment kThroughJump{"fig25_through_jump", {}};
const Experiment kFalseRest{"fig19_from_2_0_zyz", {{"duration_s: 15", "duration_s: 13"}}};
const Experiment kCompliance{"fig27_compliance_soft_wall", {{"duration_s: 10", "duration_s: 7"}}};
const Experiment kImpedance{"fig39_impedance", {{"duration_s: 8", "duration_s: 5"}}};
const Experiment kPrintedImpedance{"fig39_printed_form", {{"duration_s: 8", "duration_s: 5"}}};
const Experiment kUnforcedImpedance{"fig39_no_force_feedback", {{"duration_s: 8", "duration_s: 5"}}};
const Experiment kAdmittance{"fig44_admittance", {{"duration_s: 8", "duration_s: 5"}}};
const Experiment kForce{"fig49_force", {}};
const Experiment kForceOutside{"fig51_force_outside", {}};
const Experiment kParallel{"fig53_parallel", {}};
const Experiment kSpringHeld{"../cosim/spring_held", {}};

std::vector<Case> cases() {
  const std::vector<Fault> yielding_tip = {tipOffAtTheEnd(), forceOffAtTheEnd(),
                                           higherPeak(&Trace::h_e, 2, "largest force on the way"),
                                           off(&Trace::p_WE, {"", "", "largest distance of the tip"}, When::kOnce),
                                           off(&Trace::p_WE, {"", "", "largest distance from the same"}, When::kOnce)};
  const auto with = [](std::vector<Fault> faults, std::initializer_list<Fault> more) {
    faults.insert(faults.end(), more);
    return faults;
  };
  return {
      {"reaches_goal",
       {kJointPd},
       {jointsOffAtTheEnd(), mistaken(kJointPd, {"gravity: full", "gravity: full, mass_scale: 1.0001"})}},
      {"decay_rate", {kJointPd}, {otherDecay(), mistaken(kJointPd, {"kp: 90", "kp: 90.02"})}},
      {"gravity_offset", {kNoGravity}, {jointsOffAtTheEnd(), mistaken(kNoGravity, {"kp: 90", "kp: 90.02"})}},
      {"noise_response",
       {kNoisyPd, kNoisyInverseDynamics},
       {largerAboutTheGoal(0, "rms of q1 about its goal, joint_pd"),
        largerAboutTheGoal(1, "rms of q1 about its goal, joint_inverse_dynamics"),
        mistaken(kNoisyPd, {"kp: 90", "kp: 90.8"})}},
      {"mass_scale_offset",
       {kWrongMasses},
       {jointsOffAtTheEnd(), mistaken(kWrongMasses, {"mass_scale: 1.2", "mass_scale: 1.20005"})}},
      {"settles_after_motion",
       {kNoInertia},
       {jointsOffAtTheEnd(), largestErrorLarger(), mistaken(kNoInertia, {"kd: 70", "kd: 76"})}},
      {"bias_offset", {kNoBias}, {jointsOffAtTheEnd(), mistaken(kNoBias, {"kp: 200", "kp: 200.05"})}},
      {"uncompensated_offset",
       {kNoCompensation, kNoBias},
       {jointsOffAtTheEnd(), largerErrors(1, "error of q1 at rest, as a part"),
        mistaken(kNoCompensation, {"kp: 200", "kp: 200.05"})}},
      {"first_torque",
       {kHighGain},
       {otherEffort("first effort tau1", 1), otherEffort("largest effort |tau1|", 5),
        mistaken(kHighGain, {"kp: 2000", "kp: 2000.000005"})}},
      {"settling",
       {kSaturated},
       {jointsOffAtTheEnd(), longerAtTheLimit(), longerOnTheWay(), higherPeak(&Trace::q, 0, "overshoot of q1"),
        higherPeak(&Trace::q, 1, "overshoot of q2"), higherPeak(&Trace::q, 2, "overshoot of q3"),
        mistaken(kSaturated, {"kd: 90", "kd: 95"})}},
      {"second_order_error",
       {kInverseDynamics},
       {off(&Trace::q,
            {"largest difference of the error of q1", "largest difference of the error of q2",
             "largest difference of the error of q3"},
            When::kThroughout),
        mistaken(kInverseDynamics, {"kp: 200", "kp: 206"})}},
      {"tracks",
       {kInverseDynamics},
       {jointsOffAtTheEnd(),
        off(&Trace::q, {"largest error of q1", "largest error of q2", "largest error of q3"}, When::kOnce),
        mistaken(kInverseDynamics, {"kd: 70", "kd: 70, mass_scale: 1.0001"})}},
      {"tracks",
       {kTipTracking},
       {tipOffAtTheEnd(),
        off(&Trace::p_WE, {"largest error of x", "largest error of y", "largest error of z"}, When::kOnce),
        off(&Trace::orientation, {"largest angle"}, When::kOnce),
        off(&Trace::orientation, {"angle from the desired orientation at the end"}, When::kAtTheEnd)}},
      {"adaptation_effect",
       {kAdaptive, kAdaptationOff},
       {largerErrors(0, "rms error of q1"), largerErrors(1, "part of the rms error of q1")}},
      {"compliance_force",
       {kCompliance},
       {higherPeak(&Trace::h_e, 2, "largest force on the way"),
        mistaken(kCompliance, {"stiffness_N_per_m: 50", "stiffness_N_per_m: 50.1"})}},
      {"adaptation_learns",
       {kTuned},
       {largerErrors(0, "rms error of q1, first quarter"), mistaken(kTuned, {"k: 0.005", "k: 0.006"})}},
      {"task_goal", {kFreeCompliance}, {tipOffAtTheEnd(), off(&Trace::orientation, {"angle from"}, When::kAtTheEnd)}},
      {"no_contact", {kFreeCompliance}, {aTouch()}},
      {"angle_jump",
       {kThroughJump},
       {anotherJump(), otherJump(0, "jump of phi"), otherJump(2, "jump of psi"), thetaMoves(),
        off(&Trace::q, {"q1 at the jump"}, When::kThroughout), noJump()}},
      {"spurious_equilibrium",
       {kFalseRest},
       {off(&Trace::q, {"q1 at", "q2 at", "q3 at"}, When::kAtTheEnd), tipFartherFromItsGoal()}},
      {"task_balance",
       {kCompliance},
       {tipOffAtTheEnd(), off(&Trace::zyz, {"error of phi", "error of theta", "error of psi"}, When::kAtTheEnd),
        jointsOffAtTheEnd(), forceOffAtTheEnd(),
        mistaken(kCompliance, {"stiffness_N_per_m: 50", "stiffness_N_per_m: 50.01"})}},
      {"impedance_balance",
       {kImpedance},
       with(yielding_tip,
            {mistaken(kImpedance, {"kp: 200", "kp: 200.05"}), mistaken(kImpedance, {"md: 1,", "md: 1.000003,"}),
             mistaken(kImpedance, {"kd: 30", "kd: 30.00002"})})},
      {"printed_impedance_balance",
       {kPrintedImpedance},
       {tipOffAtTheEnd(), forceOffAtTheEnd(), mistaken(kPrintedImpedance, {"kp: 200", "kp: 200.05"})}},
      {"unforced_impedance_balance",
       {kUnforcedImpedance},
       {tipOffAtTheEnd(), forceOffAtTheEnd(), mistaken(kUnforcedImpedance, {"kp: 200", "kp: 200.05"})}},
      {"admittance_balance",
       {kAdmittance},
       with(yielding_tip,
            {mistaken(kAdmittance, {"kpt: 200", "kpt: 200.1"}), mistaken(kAdmittance, {"mt: 1,", "mt: 1.000003,"}),
             mistaken(kAdmittance, {"kdt: 30", "kdt: 30.00002"})})},
      {"force_goal",
       {kForce},
       {forceOffAtTheEnd(), off(&Trace::p_WE, {"", "", "depth in the wall"}, When::kAtTheEnd),
        off(&Trace::p_WE, {"x_F - x_e along x", "x_F - x_e along y", "x_F - x_e along z"}, When::kAtTheEnd),
        mistaken(kForce, {"force_N: [0, 0, 3]", "force_N: [0, 0, 3.0006]"})}},
      {"force_drift",
       {kForceOutside},
       {forceOffAtTheEnd(),
        off(&Trace::p_WE, {"speed of the tip along x", "speed of the tip along y", "speed of the tip along z"},
            When::kAtTheEnd),
        mistaken(kForceOutside, {"ki: 0.2", "ki: 0.20004"})}},
      {"parallel_goal",
       {kParallel},
       {tipOffAtTheEnd(), forceOffAtTheEnd(), mistaken(kParallel, {"force_N: [0, 0, 3]", "force_N: [0, 0, 3.0006]"})}},
      {"same_bytes_in_one_process", {kSpringHeld}, {oneBitOff()}},
      {"coupling_growth",
       {kSpringHeld},
       {mistaken(kSpringHeld, {"stiffness_N_per_m: 1000", "stiffness_N_per_m: 1000.002"}),
        mistaken(kSpringHeld, {"stiffness_N_per_m: 1000", "stiffness_N_per_m: 1005"})}},
  };
}

class TheoryCheck : public testing::TestWithParam<Case> {
 protected:
  const Traces runs_ = [] {
    Traces runs;
    for (const Experiment& one : GetParam().runs) runs.push_back(simulate(reportScenario(one.scenario, one.changes)));
    return runs;
  }();

  [[nodiscard]] static Checks judge(const Traces& runs) {
    CheckRequest request;
    request.name = GetParam().check;
    if (runs.size() > 1) request.other = 1;
    return runCheck(request, runs);
  }
};

TEST_P(TheoryCheck, PassesARunAsItShouldBeAndNoneThatIsOff) {
  const Checks good = judge(runs_);
  ASSERT_FALSE(good.empty());
  for (const Check& check : good) {
    EXPECT_TRUE(check.passes()) << check.what << ": predicted " << check.predicted << ", measured " << check.measured;
  }
  std::vector<bool> can_fail(good.size(), false);
  for (const Fault& fault : GetParam().faults) {
    SCOPED_TRACE(fault.what);
    Traces spoilt = runs_;
    fault.put(spoilt, good);
    const Checks bad = judge(spoilt);
    ASSERT_EQ(bad.size(), good.size());
    double least = std::numeric_limits<double>::infinity();  // distance from theory of what fails, in tolerances
    for (std::size_t i = 0; i < bad.size(); ++i) {
      if (bad[i].passes()) continue;
      can_fail[i] = true;
      const double distance = std::abs(bad[i].measured - bad[i].predicted);
      least = std::min(least, bad[i].tolerance > 0.0 ? distance / allowed(bad[i]) : 1.0);  // or exact, and then counted
    }
    EXPECT_LT(least, 2.0 * kBeyond) << "passes, or is off by more than is asked of the check to notice";
  }
  for (std::size_t i = 0; i < good.size(); ++i) EXPECT_TRUE(can_fail[i]) << good[i].what;
}

TEST_P(TheoryCheck, DoesNotPassOnWhatWasNotRecorded) {
  // A number that does not change when part of a run is missing did not look at that part; any other must fail.
  const Checks good = judge(runs_);
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const Eigen::Index steps = runs_[run].steps(), half = steps / 2;
    for (const auto& [begin, count] :
         {std::pair{Eigen::Index{0}, steps}, {Eigen::Index{0}, half}, {half, steps - half}}) {
      Traces holed = runs_;
      Trace& trace = holed[run];
      for (const Signal signal : {&Trace::q, &Trace::qd, &Trace::tau, &Trace::q_d, &Trace::qd_d, &Trace::qdd_d,
                                  &Trace::p_WE, &Trace::p_WE_d, &Trace::orientation, &Trace::zyz, &Trace::zyz_d,
                                  &Trace::V_WE_d, &Trace::A_WE_d, &Trace::h_e, &Trace::h_d}) {
        (trace.*signal).middleCols(begin, count).setConstant(kNan);
      }
      std::fill_n(trace.chain.begin() + begin, count, 0);
      const Checks bad = judge(holed);
      ASSERT_FALSE(bad.empty());
      for (std::size_t i = 0; i < bad.size(); ++i) {
        const bool did_not_look =
            i < good.size() && bad[i].predicted == good[i].predicted && bad[i].measured == good[i].measured;
        EXPECT_TRUE(!bad[i].passes() || did_not_look)
            << bad[i].what << " without steps " << begin << " to " << begin + count;
        EXPECT_FALSE(bad[i].passes() && runs_.size() == 1 && count == steps) << bad[i].what << " without a run";
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllChecks, TheoryCheck, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& one) {
                           const std::string& scenario = one.param.runs.front().scenario;
                           return one.param.check + "_of_" + scenario.substr(scenario.rfind('/') + 1);
                         });

TEST(TheoryChecks, EachIsTestedHere) {
  std::set<std::string> tested;
  for (const Case& one : cases()) tested.insert(one.check);
  const std::vector<std::string> names = checkNames();
  EXPECT_EQ(tested, std::set<std::string>(names.begin(), names.end()));
}

TEST(TheoryChecks, TheRecordedReferenceIsTheScenariosToTheBit) {
  const Trace good = simulate(reportScenario("fig53_parallel", {{"duration_s: 12", "duration_s: 0.1"}}));
  EXPECT_TRUE(followsScenario(good).passes());
  for (const Signal signal : {&Trace::q_d, &Trace::qd_d, &Trace::qdd_d, &Trace::p_WE_d, &Trace::zyz_d, &Trace::V_WE_d,
                              &Trace::A_WE_d, &Trace::h_d}) {
    for (const Eigen::Index row : {0, 2}) {
      Trace bad = good;
      double& number = (bad.*signal)(row, 70);
      number = std::nextafter(number, 1.0);
      EXPECT_FALSE(followsScenario(bad).passes());
      number = kNan;
      EXPECT_FALSE(followsScenario(bad).passes());
    }
  }
}

TEST(TheoryChecks, NotANumberNeverPasses) {
  const Check good{
      .what = "x", .unit = "m", .predicted = 1.0, .measured = 1.0, .tolerance = 1e-3, .is_relative = false};
  for (const bool is_relative : {false, true}) {
    for (double Check::*number : {&Check::predicted, &Check::measured, &Check::tolerance}) {
      Check bad = good;
      bad.is_relative = is_relative;
      EXPECT_TRUE(bad.passes());
      bad.*number = kNan;
      EXPECT_FALSE(bad.passes());
    }
  }
}

}  // namespace
}  // namespace baton::test
