// What a law would have commanded in a recorded run: exactly what it commanded where it held the baton.
#include "whatif/counterfactual.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.hpp"
#include "control/law.hpp"
#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "dds/topics.hpp"
#include "mcap/writer.hpp"
#include "messages/loop.hpp"
#include "messages/parameters.hpp"
#include "robot/kinematics.hpp"
#include "runtime/scenario_edit.hpp"
#include "support/processes.hpp"
#include "support/short_contact.hpp"
#include "whatif/command_file.hpp"

namespace baton::test {
namespace {
namespace fs = std::filesystem;

/// A law with an integrator, one with a filter, and one without memory.
std::string scenarioText() {
  return editScenario(shortContact(), {{"controllers",
                                        "[{name: force, law: force_pi}, {name: yielding, law: admittance},"
                                        " {name: pd, law: joint_pd}]"},
                                       {"active", "yielding"},
                                       {"swaps", "[]"}});
}

/// What is not recorded of a step.
struct Without {
  bool reference = false;
  bool contact = false;
};

/// A recording that a test writes step by step. The motion is none that an arm would make: a law does not mind.
class Written {
 public:
  explicit Written(const std::string& name = "run") : file_(fileCalled(name)) {
    attach("scenario.yaml", scenario.text);
    attach("robot.yaml", scenario.robot_text);
  }
  ~Written() { fs::remove(file_); }
  Written(const Written&) = delete;
  Written& operator=(const Written&) = delete;

  /// Everything but the commands; returns it as a controller sees it.
  LawInput step(std::uint64_t k, const std::string& holder, const Without& without = {}) {
    const auto phase = static_cast<double>(k) * 0.1;
    const JointVector q = Vector3(0.4 + 0.1 * std::sin(phase), 0.15, 0.08 + 0.02 * std::cos(phase));
    const JointVector qd = Vector3(std::cos(phase), 0.1, -0.2 * std::sin(phase));
    const RobotState state{q, qd, tipPose(scenario.robot, q), Vector6::Constant(0.1 * phase),
                           Vector3(1.0 + phase, -2.0, 3.0)};
    const Reference reference{.q = q + qd * 0.01,
                              .qd = qd,
                              .qdd = JointVector::Zero(3),
                              .has_task = true,
                              .X_WE = state.X_WE,
                              .V_WE = Vector6::Constant(0.05),
                              .A_WE = Vector6::Zero(),
                              .h_d = (Vector6() << 0, 0, 3, 0, 0, 0).finished()};
    Contact contact;
    contact.h_e(2) = 2.0 + std::sin(phase);
    contact.penetration = 0.01;
    LawInput input{.dt_s = scenario.stepSeconds(), .state = {}, .contact = {}, .reference = {}};
    msg::PlantState state_message;
    toMessage(stampOf(k, scenario.step_ns), state, holder, 100 + k, state_message);
    hashes_ = {write(states_, state_message, k), 0, 0};
    EXPECT_TRUE(fromMessage(state_message, 3, input.state));
    msg::Reference reference_message;
    toMessage(stampOf(k, scenario.step_ns), reference, reference_message);
    if (!without.reference) hashes_[1] = write(references_, reference_message, k);
    EXPECT_TRUE(fromMessage(reference_message, 3, input.reference));
    msg::Contact contact_message;
    toMessage(stampOf(k, scenario.step_ns), contact, contact_message);
    if (!without.contact) hashes_[2] = write(contacts_, contact_message, k);
    EXPECT_TRUE(fromMessage(contact_message, input.contact));
    return input;
  }
  /// Computed from the inputs of the step written last.
  void command(std::uint64_t k, const std::string& controller, const JointVector& effort) {
    msg::JointCommand message;
    toMessage(stampOf(k, scenario.step_ns), controller, effort, dds::inputsHash(hashes_), message);
    write(commands_, message, k);
  }
  void handover(const std::string& from, const std::string& to, std::uint64_t at_step, bool hard,
                msg::SwapPhase phase = msg::SWAP_COMMIT) {
    msg::SwapPlan plan;
    plan.plan_id(at_step);
    plan.phase(phase);
    plan.outgoing(from);
    plan.incoming(to);
    plan.at_step(at_step);
    plan.hard(hard);
    write(plans_, plan, at_step - 5);
  }
  void change(const std::string& controller, const ParameterValues& values, std::uint64_t at_step) {
    msg::Decision decision;
    decision.step(at_step - 1);
    decision.cause(msg::DECISION_PARAMETERS);
    decision.controller(controller);
    decision.at_step(at_step);
    decision.values() = toMessages(values);
    write(decisions_, decision, at_step - 1);
  }
  /// Everything so far was another take.
  void reset() {
    log_time_ns_ += 1'000'000;
    msg::Rewind rewind;
    rewind.take(1);
    rewind.phase(msg::REWIND_COMMIT);
    write(rewinds_, rewind, 0);
  }
  const fs::path& close() {
    writer_.close();
    return file_;
  }

  const Scenario scenario = parseScenario("short.yaml", scenarioText(), "robot.yaml",
                                          loadScenario((deployFolder() / "scenarios/demo.yaml").string()).robot_text);

 private:
  static fs::path fileCalled(const std::string& name) {
    return fs::temp_directory_path() / ("baton-whatif-test-" + std::to_string(getpid()) + "-" + name + ".mcap");
  }
  static mcap::WriterOptions options() {
    mcap::WriterOptions options;
    options.sync_on_close = false;
    options.if_exists = mcap::OutputFile::IfExists::kReplace;
    return options;
  }
  void attach(const char* name, const std::string& text) {
    writer_.addAttachment(name, "application/yaml", 0, 0, mcap::asBytes(text));
  }
  template <class T>
  std::uint64_t write(mcap::ChannelId channel, const T& message, std::uint64_t k) {
    std::vector<std::byte> buffer(dds::maxPayload<T>());
    const auto payload = dds::encode(message, buffer);
    writer_.write(channel, 0, log_time_ns_ + 1000 * k, 7 + 1000 * k, payload);
    return dds::chainHash(0, payload);
  }
  mcap::ChannelId channel(const char* topic) { return writer_.addChannel(topic, "cdr", mcap::kNoSchema); }

  const fs::path file_;
  mcap::Writer writer_{file_, options()};
  const mcap::ChannelId states_ = channel(dds::topics::kPlantState.name),
                        references_ = channel(dds::topics::kReference.name),
                        contacts_ = channel(dds::topics::kContact.name),
                        commands_ = channel(dds::topics::kJointCommand.name),
                        plans_ = channel(dds::topics::kSwapPlan.name),
                        decisions_ = channel(dds::topics::kDecision.name),
                        rewinds_ = channel(dds::topics::kRewind.name);
  std::array<std::uint64_t, 3> hashes_{};
  std::uint64_t log_time_ns_ = 0;
};

/// The effort of a law, which has one.
JointVector effortOf(Law& law, const LawInput& input) {
  JointVector effort = JointVector::Zero(3);
  EXPECT_EQ(law.step(input, effort), LawStatus::kOk);
  return effort;
}

/// What a law remembers, to another one of its kind.
void handOn(Law& from, Law& to) {
  std::vector<std::byte> room(8192);
  StateArchive saved = StateArchive::into(room);
  from.archive(saved);
  StateArchive restored = StateArchive::from(std::span(room).first(saved.size()));
  to.archive(restored);
}

/// The admittance law hands over to the force law at step 10, which gets another gain at step 15 and hands back at step
/// 20, without help; the last step is open. Each command as the laws give it by their own contract.
void writeRun(Written& file, double disturbance = 0.0) {
  const auto yielding = makeLaw("admittance", file.scenario.robot, {});
  const auto force = makeLaw("force_pi", file.scenario.robot, {});
  const auto stronger = makeLaw("force_pi", file.scenario.robot, {{"kd", std::vector{40.0}}});
  yielding->reset();
  file.handover("yielding", "force", 10, false);
  file.handover("force", "pd", 17, true);  // came to nothing
  file.handover("force", "pd", 17, true, msg::SWAP_CANCEL);
  file.handover("force", "yielding", 20, true);
  file.change("force", {{"kd", std::vector{40.0}}}, 15);
  for (std::uint64_t k = 0; k < 30; ++k) {
    const LawInput input = file.step(k, k < 10 || k >= 20 ? "yielding" : "force");
    if (k == 10) force->handover(input);
    if (k == 15) handOn(*force, *stronger);
    if (k == 20) yielding->reset();
    if (k <= 10 || k >= 20) file.command(k, "yielding", effortOf(*yielding, input));
    if (k >= 10 && k <= 20) {
      JointVector effort = effortOf(k < 15 ? *force : *stronger, input);
      if (k == 17) effort(1) += disturbance;
      file.command(k, "force", effort);
    }
  }
  (void)file.step(30, "yielding");
}

TEST(Counterfactual, ReproducesWhoHeldTheBaton) {
  Written file;
  writeRun(file);
  const fs::path& recording = file.close();
  const Counterfactual force = counterfactual(recording, {.law = "", .as = "force", .settings = {}});
  EXPECT_TRUE(force.overall.isExact());
  EXPECT_EQ(force.overall.steps(), 10U);
  EXPECT_EQ(force.changes, 1U);
  EXPECT_EQ(force.steps, 31U);
  EXPECT_EQ(force.run_hash, 130U);
  EXPECT_NE(toText(force).find("reproduces the recorded torque exactly"), std::string::npos) << toText(force);
  ASSERT_EQ(force.tenures.size(), 3U);
  EXPECT_TRUE(force.tenures[1].difference.isExact());
  EXPECT_FALSE(force.tenures[0].difference.isExact()) << "another law held it";

  const Counterfactual yielding = counterfactual(recording, {.law = "", .as = "yielding", .settings = {}});
  EXPECT_TRUE(yielding.overall.isExact());
  EXPECT_EQ(yielding.overall.steps(), 20U) << "what it commanded once more is compared with the one who held it";
  for (const Gap& gap :
       {yielding.without_inputs, yielding.without_effort, yielding.without_recorded, yielding.with_other_inputs}) {
    EXPECT_EQ(gap.steps, 0U) << "nobody need have commanded for the last step: " << gap.first_step;
  }
  EXPECT_TRUE(toJson(yielding).at("exact"));
}

TEST(Counterfactual, OneBitMoreIsNotExact) {
  Written file;
  writeRun(file, 1e-15);
  const Counterfactual made = counterfactual(file.close(), {.law = "", .as = "force", .settings = {}});
  EXPECT_FALSE(made.overall.isExact());
  EXPECT_EQ(made.overall.differentSteps(), 1U);
  EXPECT_EQ(made.overall.firstDifferentStep(), 17U);
  EXPECT_EQ(made.overall.joints().at(1).largest_at_step, 17U);
  EXPECT_EQ(made.overall.joints().at(0).largest, 0.0);
  EXPECT_NE(toText(made).find("does not reproduce the recorded torque: 1 of 10 steps differ, first step 17"),
            std::string::npos)
      << toText(made);
}

TEST(Counterfactual, ValuesThatAreSetStayAndOtherLawsHaveTheirOwn) {
  Written file;
  writeRun(file);
  const fs::path& recording = file.close();
  // As the first five steps had it, so that only the change of step 15 is missing.
  const ParameterValues defaults = file.scenario.controller("force").parameters;
  const Counterfactual kept =
      counterfactual(recording, {.law = "", .as = "force", .settings = {"kd=" + toText(defaults.at("kd"))}});
  EXPECT_EQ(kept.changes, 0U);
  EXPECT_EQ(kept.overall.firstDifferentStep(), 15U);
  const Counterfactual other = counterfactual(recording, {.law = "joint_pd", .as = "force", .settings = {"kp=40"}});
  EXPECT_EQ(other.law, "joint_pd");
  EXPECT_EQ(other.changes, 0U) << "of a parameter that it does not have";
  EXPECT_EQ(std::get<std::vector<double>>(other.parameters.at("kp")), std::vector<double>(3, 40.0));
  EXPECT_EQ(other.overall.steps(), 10U);
  EXPECT_FALSE(other.overall.isExact());
}

TEST(Counterfactual, ALawHoldsTheBatonAllTheTimeOrStandsBy) {
  Written file;
  std::vector<LawInput> inputs;
  for (std::uint64_t k = 0; k < 20; ++k) inputs.push_back(file.step(k, k < 5 ? "" : "pd"));
  const fs::path& recording = file.close();
  std::vector<JointVector> held, shadow;
  const auto into = [](std::vector<JointVector>& efforts) {
    return [&efforts](const RecordedStep&, const JointVector& effort, std::uint64_t) { efforts.push_back(effort); };
  };
  const Counterfactual made = counterfactual(recording, {.law = "force_pi", .as = "", .settings = {}}, into(held));
  (void)counterfactual(recording, {.law = "force_pi", .as = "", .settings = {}, .in_shadow = true}, into(shadow));
  const auto law = makeLaw("force_pi", file.scenario.robot, {}), other = makeLaw("force_pi", file.scenario.robot, {});
  law->reset();
  ASSERT_EQ(held.size(), inputs.size());
  ASSERT_EQ(shadow.size(), inputs.size());
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    EXPECT_EQ(held[k], effortOf(*law, inputs[k])) << k;
    other->handover(inputs[k]);
    EXPECT_EQ(shadow[k], effortOf(*other, inputs[k])) << k;
  }
  EXPECT_NE(held.back(), shadow.back()) << "one integrates, the other does not";
  ASSERT_EQ(made.tenures.size(), 2U);
  EXPECT_EQ(made.tenures[0].difference.steps(), 5U) << "what the joints felt under the brake";
  double largest = 0.0;
  for (std::size_t k = 0; k < 5; ++k) largest = std::max(largest, std::abs(held[k](1) + 2.0));
  EXPECT_EQ(made.tenures[0].difference.joints().at(1).largest, largest);
  EXPECT_EQ(made.without_recorded.steps, 14U) << "of which nobody has a command; the last step is open";
  EXPECT_EQ(made.without_recorded.first_step, 5U);
}

TEST(Counterfactual, SaysWhatIsMissing) {
  Written file;
  const auto law = makeLaw("force_pi", file.scenario.robot, {});
  law->reset();
  for (std::uint64_t k = 0; k < 12; ++k) {
    if (k == 3 || k == 4) continue;
    const LawInput input = file.step(k, "force", {.reference = k == 6, .contact = k == 8});
    const bool is_missing = k == 6 || k == 8;
    if (!is_missing) file.command(k, "force", effortOf(*law, input));
  }
  const fs::path& recording = file.close();
  const Counterfactual made = counterfactual(recording, {.law = "force_pi", .as = "", .settings = {}});
  EXPECT_EQ(made.without_inputs.steps, 4U);
  EXPECT_EQ(made.without_inputs.first_step, 3U);
  EXPECT_EQ(made.without_recorded.steps, 2U);
  EXPECT_EQ(made.steps, 10U);
  EXPECT_TRUE(made.overall.isExact()) << "a law goes on where it was";
  EXPECT_EQ(made.overall.steps(), 8U);
  EXPECT_NE(toText(made).find("4 steps not recorded whole: the law was not asked, first step 3"), std::string::npos);
  // One that is blind to force misses less.
  EXPECT_EQ(counterfactual(recording, {.law = "joint_pd", .as = "", .settings = {}}).without_inputs.steps, 3U);
}

TEST(Counterfactual, NoticesThatTheHolderSawSomethingElse) {
  Written file;
  const auto law = makeLaw("joint_pd", file.scenario.robot, {});
  for (std::uint64_t k = 0; k < 2; ++k) file.command(k, "pd", effortOf(*law, file.step(k, "pd")));
  (void)file.step(2, "pd");
  const Counterfactual made = counterfactual(file.close(), {.law = "", .as = "pd", .settings = {}});
  EXPECT_EQ(made.with_other_inputs.steps, 2U) << "the commands name the contact, which joint_pd is not given";
}

TEST(Counterfactual, IsOfTheLastTake) {
  Written file;
  for (std::uint64_t k = 0; k < 50; ++k) (void)file.step(k, "pd");
  file.reset();
  writeRun(file);
  const Counterfactual made = counterfactual(file.close(), {.law = "", .as = "yielding", .settings = {}});
  EXPECT_EQ(made.steps, 31U);
  EXPECT_EQ(made.tenures.size(), 3U);
}

TEST(Counterfactual, RefusesWhatCannotBeAnswered) {
  Written file, blind("blind");
  for (std::uint64_t k = 0; k < 3; ++k) {
    (void)file.step(k, "pd");
    (void)blind.step(k, "pd", {.reference = false, .contact = true});
  }
  const auto refused = [](const fs::path& recording, const CounterfactualWish& wish) -> std::string {
    try {
      (void)counterfactual(recording, wish);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  const fs::path &recording = file.close(), &without_contact = blind.close();
  const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
  EXPECT_PRED2(has, refused(recording, {}), "expected a law");
  EXPECT_PRED2(has, refused(recording, {.law = "nonsense", .as = "", .settings = {}}), "nonsense");
  EXPECT_PRED2(has, refused(recording, {.law = "", .as = "nobody", .settings = {}}), "nobody");
  EXPECT_PRED2(has, refused(recording, {.law = "joint_pd", .as = "", .settings = {"kq=1"}}), "kq");
  EXPECT_PRED2(has, refused(recording, {.law = "joint_pd", .as = "", .settings = {"kp=1", "kp=2"}}), "twice");
  EXPECT_PRED2(has, refused(recording, {.law = "joint_pd", .as = "", .settings = {"kp"}}), "NAME=VALUE");
  EXPECT_PRED2(has, refused(without_contact, {.law = "force_pi", .as = "", .settings = {}}), "contact forces");
  EXPECT_EQ(refused(without_contact, {.law = "joint_pd", .as = "", .settings = {}}), "");
}

TEST(CommandFile, HasTheEffortsAtTheTimesOfTheirSteps) {
  Written file;
  writeRun(file);
  const fs::path made = fs::temp_directory_path() / ("baton-whatif-commands-" + std::to_string(getpid()) + ".mcap");
  std::vector<JointVector> efforts;
  {
    CommandFile commands(made, "pd", file.scenario.step_ns);
    (void)counterfactual(file.close(), {.law = "joint_pd", .as = "", .settings = {}},
                         [&](const RecordedStep& step, const JointVector& effort, std::uint64_t hash) {
                           efforts.push_back(effort);
                           commands.write(step, effort, hash);
                         });
    commands.close({{"law", "joint_pd"}});
  }
  const mcap::Reader reader(made);
  ASSERT_EQ(reader.channels().size(), 1U);
  EXPECT_EQ(reader.channels().begin()->second.topic, "whatif_command");
  EXPECT_EQ(reader.channels().begin()->second.message_encoding, "cdr");
  EXPECT_EQ(reader.schemas().begin()->second.name, "baton::msg::JointCommand");
  EXPECT_EQ(reader.schemas().begin()->second.encoding, "omgidl");
  ASSERT_EQ(reader.metadata().size(), 1U);
  EXPECT_EQ(reader.metadata()[0].name, "baton.whatif");
  EXPECT_EQ(reader.metadata()[0].values.at("law"), "joint_pd");
  std::uint64_t k = 0;
  reader.forEachMessage({}, [&](const mcap::MessageView& view) {
    EXPECT_EQ(view.log_time_ns, 1000 * k);
    EXPECT_EQ(view.publish_time_ns, 7 + 1000 * k);
    msg::JointCommand command;
    ASSERT_TRUE(dds::decode(view.data, command));
    EXPECT_EQ(command.step(), k);
    EXPECT_EQ(command.controller(), "pd");
    EXPECT_EQ(command.effort(), std::vector<double>(efforts[k].begin(), efforts[k].end()));
    ++k;
  });
  EXPECT_EQ(k, 31U);
  fs::remove(made);
}

}  // namespace
}  // namespace baton::test
