/// What every registered law must do, whatever its equation. A law joins by being registered; nothing here names one.
#include <gtest/gtest.h>

#include <set>

#include "support/allocation_guard.hpp"
#include "unit/control/closed_loop.hpp"

namespace baton {
namespace {

using namespace test;

/// A law with one of its words changed from the default, or none.
struct Variant {
  std::string law;
  ParameterValues parameters;
  std::string label;
};

std::vector<Variant> allVariants() {
  std::vector<Variant> variants;
  for (const LawInfo& info : allLaws()) {
    variants.push_back({info.name, {}, info.name});
    for (const ParameterSpec& spec : info.parameters) {
      for (std::size_t i = 1; i < spec.choices.size(); ++i) {
        const std::string& word = spec.choices[i];
        variants.push_back({info.name, {{spec.name, word}}, info.name + "_" + spec.name + "_" + word});
      }
    }
  }
  return variants;
}

constexpr int kSamples = 200;

/// A random step in the life of a law: everything present and finite.
LawInput randomInput(const RobotModel& robot, std::mt19937& generator) {
  const int n = robot.size();
  LawInput input;
  input.dt_s = 5e-4;
  input.state = stateOf(robot, randomJointVector(generator, n, 0.5), randomJointVector(generator, n, 1.0));
  input.state.tau_applied = randomJointVector(generator, n, 10.0);
  input.contact.h_e = randomJointVector(generator, 6, 5.0);
  const JointVector q = randomJointVector(generator, n, 0.5), qd = randomJointVector(generator, n, 1.0);
  input.reference = referenceOf(robot, q, qd, randomJointVector(generator, n, 1.0));
  input.reference.h_d = randomJointVector(generator, 6, 5.0);
  return input;
}

std::vector<LawInput> randomInputs(const RobotModel& robot, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<LawInput> inputs;
  inputs.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) inputs.push_back(randomInput(robot, generator));
  return inputs;
}

JointVector markerFor(const RobotModel& robot) { return JointVector::Constant(robot.size(), 12345.0); }

/// Status and effort of each step; an effort left alone stays the marker.
struct Answer {
  LawStatus status;
  JointVector tau;
  bool operator==(const Answer& other) const { return status == other.status && tau == other.tau; }
};

Answer answer(Law& law, const RobotModel& robot, const LawInput& input) {
  Answer result{LawStatus::kOk, markerFor(robot)};
  result.status = law.step(input, result.tau);
  return result;
}

/// Standing by for the first half (handover before every step), holding the baton for the second.
std::vector<Answer> life(Law& law, const RobotModel& robot, const std::vector<LawInput>& inputs) {
  std::vector<Answer> answers;
  law.reset();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (i < inputs.size() / 2) law.handover(inputs[i]);
    answers.push_back(answer(law, robot, inputs[i]));
  }
  return answers;
}

std::vector<RobotModel> robots() {
  return {rppRobot(), link1Robot(), randomChain(5, 101), randomRevoluteChain(8, 102)};
}

class LawConformance : public testing::TestWithParam<Variant> {
 protected:
  static std::unique_ptr<Law> make(const RobotModel& robot) {
    return makeLaw(GetParam().law, robot, GetParam().parameters);
  }
};

TEST_P(LawConformance, AnswersAreFiniteOrRefused) {
  for (const RobotModel& robot : robots()) {
    const auto law = make(robot);
    int good = 0;
    for (const Answer& a : life(*law, robot, randomInputs(robot, 1))) {
      if (a.status == LawStatus::kOk) {
        ++good;
        EXPECT_EQ(a.tau.size(), robot.size());
        EXPECT_TRUE(a.tau.allFinite());
      } else {
        EXPECT_EQ(a.status, LawStatus::kSingular);  // nothing else is wrong with these inputs
        EXPECT_EQ(a.tau, markerFor(robot));
      }
    }
    // A short arm whose tip lies on its joint's axis cannot move it at all; the others are seldom near a singularity.
    if (robot.name != "link1") {
      EXPECT_GE(good, kSamples * 9 / 10) << robot.name << ", n = " << robot.size();
    }
  }
}

TEST_P(LawConformance, TwoInstancesGiveTheSameBits) {
  for (const RobotModel& robot : robots()) {
    const auto inputs = randomInputs(robot, 2);
    EXPECT_TRUE(life(*make(robot), robot, inputs) == life(*make(robot), robot, inputs));
  }
}

TEST_P(LawConformance, ResetForgetsEverything) {
  for (const RobotModel& robot : robots()) {
    const auto law = make(robot);
    const auto inputs = randomInputs(robot, 3);
    const auto first = life(*law, robot, inputs);
    (void)life(*law, robot, randomInputs(robot, 4));
    EXPECT_TRUE(life(*law, robot, inputs) == first);
  }
}

TEST_P(LawConformance, GoesOnFromACheckpointWithTheSameBits) {
  for (const RobotModel& robot : robots()) {
    const auto inputs = randomInputs(robot, 12);
    const std::span<const LawInput> first(inputs.data(), inputs.size() / 2),
        second(inputs.data() + first.size(), first.size());
    const auto original = make(robot), restored = make(robot);
    original->reset();
    restored->reset();
    for (const LawInput& input : first) (void)answer(*original, robot, input);
    for (const LawInput& input : second) (void)answer(*restored, robot, input);  // another past, to be forgotten

    std::array<std::byte, 8192> bytes{};
    StateArchive saved = StateArchive::into(bytes);
    original->archive(saved);
    ASSERT_TRUE(saved.isGood());
    StateArchive read = StateArchive::from(std::span(bytes).first(saved.size()));
    restored->archive(read);
    ASSERT_TRUE(read.isWhole());
    for (const LawInput& input : second) {
      EXPECT_TRUE(answer(*restored, robot, input) == answer(*original, robot, input)) << robot.name;
    }
  }
}

TEST_P(LawConformance, NeverAllocates) {
  if (!AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer has its own malloc";
  for (const RobotModel& robot : robots()) {
    const auto law = make(robot);
    const auto inputs = randomInputs(robot, 5);
    JointVector tau;
    const AllocationGuard guard;
    law->reset();
    for (const LawInput& input : inputs) {
      law->handover(input);
      (void)law->step(input, tau);
      (void)law->step(input, tau);
    }
    EXPECT_EQ(guard.count(), 0u) << "n = " << robot.size();
  }
}

/// Every number of an input that could turn into NaN on its way.
std::vector<std::pair<std::string, std::function<double*(LawInput&)>>> numbersOf() {
  return {{"q", [](LawInput& in) { return in.state.q.data(); }},
          {"qd", [](LawInput& in) { return in.state.qd.data(); }},
          {"tau_applied", [](LawInput& in) { return in.state.tau_applied.data(); }},
          {"X_WE", [](LawInput& in) { return in.state.X_WE.p.data(); }},
          {"V_WE", [](LawInput& in) { return in.state.V_WE.data(); }},
          {"h_e", [](LawInput& in) { return in.contact.h_e.data(); }},
          {"reference q", [](LawInput& in) { return in.reference.q.data(); }},
          {"reference qd", [](LawInput& in) { return in.reference.qd.data(); }},
          {"reference qdd", [](LawInput& in) { return in.reference.qdd.data(); }},
          {"reference p", [](LawInput& in) { return in.reference.X_WE.p.data(); }},
          {"reference R", [](LawInput& in) { return in.reference.X_WE.R.data(); }},
          {"reference V", [](LawInput& in) { return in.reference.V_WE.data(); }},
          {"reference A", [](LawInput& in) { return in.reference.A_WE.data(); }},
          {"h_d", [](LawInput& in) { return in.reference.h_d.data(); }},
          {"dt", [](LawInput& in) { return &in.dt_s; }}};
}

TEST_P(LawConformance, NotANumberIsRefusedOrNotLookedAtAndLeavesNoTrace) {
  const RobotModel robot = rppRobot();
  const auto inputs = randomInputs(robot, 6);
  for (const double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::set<std::string> refused;
    for (const auto& [name, number] : numbersOf()) {
      const auto law = make(robot), clean = make(robot);
      law->reset();
      clean->reset();
      for (const LawInput& input : inputs) {
        LawInput bad = input;
        *number(bad) = poison;
        const Answer to_bad = answer(*law, robot, bad);
        if (to_bad.status == LawStatus::kNotFinite) {
          refused.insert(name);
          EXPECT_EQ(to_bad.tau, markerFor(robot)) << name;
          EXPECT_TRUE(answer(*law, robot, input) == answer(*clean, robot, input)) << name;
        } else {
          EXPECT_TRUE(to_bad == answer(*clean, robot, input)) << name;
        }
      }
    }
    EXPECT_TRUE(refused.count("q") == 1 && refused.count("qd") == 1);
  }
}

TEST_P(LawConformance, HandoverOnNotANumberDoesNotPoisonTheLaw) {
  const RobotModel robot = rppRobot();
  const auto inputs = randomInputs(robot, 7);
  for (const auto& [name, number] : numbersOf()) {
    const auto law = make(robot);
    law->reset();
    LawInput bad = inputs[0];
    *number(bad) = std::nan("");
    law->handover(bad);
    EXPECT_EQ(answer(*law, robot, inputs[1]).status, LawStatus::kOk) << name;
  }
}

TEST_P(LawConformance, OverflowIsRefusedToo) {
  const RobotModel robot = rppRobot();
  const auto law = make(robot);
  for (LawInput input : randomInputs(robot, 8)) {
    input.state.qd.setConstant(1e308);
    law->reset();
    const Answer a = answer(*law, robot, input);
    if (a.status == LawStatus::kOk) {
      EXPECT_TRUE(a.tau.allFinite());
    } else {
      EXPECT_EQ(a.tau, markerFor(robot));
    }
  }
}

TEST_P(LawConformance, MissesAReferenceOnlyIfItFollowsIt) {
  const RobotModel robot = rppRobot();
  for (const LawInput& input : randomInputs(robot, 9)) {
    LawInput no_joint = input, no_task = input;
    no_joint.reference.q.resize(0);
    no_joint.reference.qd.resize(0);
    no_joint.reference.qdd.resize(0);
    no_task.reference.has_task = false;
    no_task.reference.X_WE.p.setConstant(std::nan(""));
    for (const LawInput& partial : {no_joint, no_task}) {
      const auto law = make(robot), whole = make(robot);
      const Answer a = answer(*law, robot, partial);
      if (a.status == LawStatus::kMissingReference) {
        EXPECT_EQ(a.tau, markerFor(robot));
      } else {
        EXPECT_TRUE(a == answer(*whole, robot, input));
      }
    }
  }
}

TEST_P(LawConformance, StandingByIsPureAndHandoverNeverWorsensTheMatch) {
  // Handing over twice is handing over once, and what comes out is no further from the effort applied, as the arm's
  // acceleration at the tip, than what a fresh law would give.
  const RobotModel robot = rppRobot();
  for (const LawInput& input : randomInputs(robot, 10)) {
    const auto fresh = make(robot), once = make(robot), twice = make(robot);
    once->handover(input);
    twice->handover(input);
    twice->handover(input);
    const Answer from_fresh = answer(*fresh, robot, input), from_once = answer(*once, robot, input);
    EXPECT_TRUE(from_once == answer(*twice, robot, input));
    if (from_once.status != LawStatus::kOk) continue;
    const double gap = (from_once.tau - input.state.tau_applied).norm();
    EXPECT_LE(gap, (from_fresh.tau - input.state.tau_applied).norm() + 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(AllLaws, LawConformance, testing::ValuesIn(allVariants()),
                         [](const testing::TestParamInfo<Variant>& variant) { return variant.param.label; });

TEST(LawRegistry, IsSortedUniqueAndFullyDescribed) {
  ASSERT_FALSE(allLaws().empty());
  const auto isSnakeCase = [](const std::string& name) {
    return !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
  };
  for (std::size_t i = 0; i < allLaws().size(); ++i) {
    const LawInfo& info = allLaws()[i];
    if (i > 0) {
      EXPECT_LT(allLaws()[i - 1].name, info.name);
    }
    EXPECT_TRUE(isSnakeCase(info.name)) << info.name;
    EXPECT_FALSE(info.summary.empty());
    EXPECT_TRUE(info.uses_force || !info.requires_contact) << info.name;
    EXPECT_EQ(&findLaw(info.name), &info);
    std::set<std::string> names;
    for (const ParameterSpec& spec : info.parameters) {
      EXPECT_TRUE(isSnakeCase(spec.name)) << spec.name;
      EXPECT_TRUE(names.insert(spec.name).second) << info.name << " " << spec.name;
      EXPECT_FALSE(spec.doc.empty());
      EXPECT_EQ(spec.size == ParameterSize::kChoice, spec.choices.size() > 1) << spec.name;
    }
    for (int n = 1; n <= kMaxJoints; ++n) EXPECT_NO_THROW((void)completeParameters(info.parameters, {}, n));
  }
}

TEST(LawRegistry, LawsThatDoNotDeclareForceDoNotLookAtIt) {
  const RobotModel robot = rppRobot();
  for (const Variant& variant : allVariants()) {
    if (findLaw(variant.law).uses_force) continue;
    for (const LawInput& input : randomInputs(robot, 11)) {
      LawInput blind = input;
      blind.contact = Contact{};
      const auto a = makeLaw(variant.law, robot, variant.parameters),
                 b = makeLaw(variant.law, robot, variant.parameters);
      EXPECT_TRUE(answer(*a, robot, input) == answer(*b, robot, blind)) << variant.label;
    }
  }
}

}  // namespace
}  // namespace baton
