// Two recordings compared: what is paired with what, what is the same, and which rules may be given.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "bag/field_rules.hpp"
#include "bag/recording_diff.hpp"
#include "base/error.hpp"
#include "schema/idl_parser.hpp"
#include "support/small_recording.hpp"

namespace baton {
namespace {

using test::SmallRecording;

class BagDiff : public testing::Test {
 protected:
  BagDiff() {
    std::string name = (std::filesystem::temp_directory_path() / "baton-diff-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~BagDiff() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  std::string write(const std::string& name, const std::function<void(SmallRecording&)>& fill) const {
    std::string path = (folder / name).string();
    SmallRecording recording(path);
    fill(recording);
    recording.close();
    return path;
  }
  RecordingDiff diff(const std::function<void(SmallRecording&)>& a, const std::function<void(SmallRecording&)>& b,
                     DiffRequest request = {}) const {
    request.a = write("a.mcap", a);
    request.b = write("b.mcap", b);
    return diffRecordings(request, [](double) {});
  }

  std::filesystem::path folder;
};

msg::JointCommand command(std::uint64_t step, double effort, std::uint64_t hash = 0) {
  msg::JointCommand message;
  message.step(step);
  message.controller("force");
  message.effort({effort, 1.0});
  message.inputs_hash(hash);
  return message;
}

/// Commands of these steps, each with an effort like its step, but for `other`.
std::function<void(SmallRecording&)> commands(const std::vector<std::uint64_t>& steps, double other = 0.0,
                                              std::uint64_t at = UINT64_MAX) {
  return [=](SmallRecording& out) {
    for (const std::uint64_t step : steps) {
      const double effort = step == at ? other : static_cast<double>(step);
      out.add(dds::topics::kJointCommand, "force", command(step, effort, step == at ? 1 : 0));
    }
  };
}

TEST_F(BagDiff, ABranchIsComparedFromWhereItBegins) {
  const auto origin = commands({0, 1, 2, 3, 4, 5}), branch = commands({3, 4, 5}, 9.0, 5);
  const RecordingDiff all = diff(origin, branch);
  EXPECT_FALSE(all.isSame());
  EXPECT_EQ(all.laterBegin(), 3U);
  const RecordingDiff common = diff(origin, branch, {.from_step = 3, .to_step = 4});
  EXPECT_TRUE(common.isSame());
  EXPECT_EQ(common.laterBegin(), std::nullopt);
  EXPECT_EQ(common.streams.at({"joint_command", "force"}).compared, 2U);
  const RecordingDiff late = diff(origin, branch, {.from_step = 4});
  EXPECT_EQ(late.streams.at({"joint_command", "force"}).different, 1U);
  EXPECT_EQ(late.streams.at({"joint_command", "force"}).only_a, 0U);
}

TEST_F(BagDiff, StepsThatARecordingDoesNotHaveAreNotTheSame) {
  for (const DiffRequest& request : {DiffRequest{.from_step = 6}, DiffRequest{.to_step = 2}}) {
    EXPECT_THROW((void)diff(commands({0, 1, 2, 3, 4, 5}), commands({3, 4, 5}), request), UsageError);
  }
}

TEST_F(BagDiff, TheSameMessagesAreTheSameWhateverTheirOrderAndTheirWriters) {
  const auto a = [](SmallRecording& out) {
    for (std::uint64_t step = 0; step < 50; ++step) {
      out.add(dds::topics::kJointCommand, "force", command(step, 1.0));
      out.add(dds::topics::kJointCommand, "impedance", command(step, 2.0));
    }
  };
  const auto b = [](SmallRecording& out) {
    for (const char* service : {"impedance", "force"}) {
      for (std::uint64_t step = 0; step < 50; ++step) {
        out.add(dds::topics::kJointCommand, service, command(step, service[0] == 'f' ? 1.0 : 2.0));
      }
    }
  };
  const RecordingDiff found = diff(a, b);
  EXPECT_TRUE(found.isSame());
  EXPECT_FALSE(found.firstDifferent());
  ASSERT_EQ(found.streams.size(), 2U);
  EXPECT_EQ(found.streams.at({"joint_command", "force"}).compared, 50U);
}

TEST_F(BagDiff, NamesTheFirstValueThatDiffers) {
  const RecordingDiff found = diff(commands({0, 1, 2, 3, 4}), commands({0, 1, 2, 3, 4}, 2.5, 2));
  ASSERT_FALSE(found.isSame());
  const StreamDiff& stream = found.streams.at({"joint_command", "force"});
  EXPECT_EQ(stream.compared, 5U);
  EXPECT_EQ(stream.different, 1U);
  ASSERT_TRUE(stream.first);
  EXPECT_EQ(stream.first->at.step, 2U);
  EXPECT_EQ(stream.first->what.field, "effort[0]");
  EXPECT_EQ(stream.first->what.a, "2.0");
  EXPECT_EQ(stream.first->what.b, "2.5");
  EXPECT_EQ(found.firstDifferent(), (StreamKey{"joint_command", "force"}));
}

TEST_F(BagDiff, AStepThatOnlyOneHasIsNotPairedWithAnother) {
  const RecordingDiff found = diff(commands({0, 1, 3, 4, 5}), commands({0, 2, 3, 4}));
  const StreamDiff& stream = found.streams.at({"joint_command", "force"});
  EXPECT_EQ(stream.compared, 3U);
  EXPECT_EQ(stream.different, 0U);
  EXPECT_EQ(stream.only_a, 2U);
  EXPECT_EQ(stream.only_b, 1U);
  ASSERT_TRUE(stream.first);
  EXPECT_EQ(stream.first->at.step, 1U);
  EXPECT_EQ(stream.first->what.b, "none");
}

TEST_F(BagDiff, StepsThatBeginAgainAreAnotherTake) {
  EXPECT_TRUE(diff(commands({0, 1, 2, 0, 1, 2, 3}), commands({0, 1, 2, 0, 1, 2, 3})).isSame());
  const RecordingDiff found = diff(commands({0, 1, 2, 0, 1}), commands({0, 1, 0, 1}));
  const StreamDiff& stream = found.streams.at({"joint_command", "force"});
  EXPECT_EQ(stream.compared, 4U);
  EXPECT_EQ(stream.only_a, 1U);
  EXPECT_EQ(stream.first->at.take, 0U);
  EXPECT_EQ(stream.first->at.step, 2U);
}

/// A run that was reset after these steps, then went over the others.
std::function<void(SmallRecording&)> resetRun(const std::vector<std::uint64_t>& before,
                                              const std::vector<std::uint64_t>& after) {
  return [=](SmallRecording& out) {
    commands(before)(out);
    msg::Rewind rewind;
    rewind.take(1);
    for (const msg::RewindPhase phase : {msg::REWIND_PREPARE, msg::REWIND_COMMIT}) {
      rewind.phase(phase);
      out.add(dds::topics::kRewind, "plant", rewind);
    }
    commands(after)(out);
  };
}

TEST_F(BagDiff, ARunThatWasResetIsComparedFromItsLastResetOn) {
  const RecordingDiff found = diff(resetRun({0, 1, 2, 3}, {0, 1, 2}), commands({0, 1, 2}));
  EXPECT_TRUE(found.isSame());
  EXPECT_EQ(found.streams.at({"joint_command", "force"}).compared, 3U);
  EXPECT_EQ(found.resets_before, (std::array<std::uint32_t, 2>{1, 0}));
  EXPECT_TRUE(diff(resetRun({0, 5}, {0, 1}), resetRun({0, 1, 2}, {0, 1})).isSame());
  const RecordingDiff other = diff(resetRun({0, 1, 2}, {0, 1, 2}), commands({0, 1}));
  EXPECT_EQ(other.streams.at({"joint_command", "force"}).only_a, 1U);
}

TEST_F(BagDiff, AResetThatWasCalledOffIsNone) {
  const auto called_off = [](SmallRecording& out) {
    commands({0, 1})(out);
    msg::Rewind rewind;
    for (const std::uint32_t take : {1U, 2U}) {  // each attempt has a number
      rewind.take(take);
      rewind.phase(msg::REWIND_PREPARE);
      out.add(dds::topics::kRewind, "plant", rewind);
      rewind.phase(take == 1 ? msg::REWIND_CANCEL : msg::REWIND_COMMIT);
      out.add(dds::topics::kRewind, "plant", rewind);
    }
    commands({0, 1, 2})(out);
  };
  const RecordingDiff found = diff(called_off, commands({0, 1, 2}));
  EXPECT_TRUE(found.isSame());
  EXPECT_EQ(found.resets_before, (std::array<std::uint32_t, 2>{1, 0}));
}

TEST_F(BagDiff, TheTakesBeforeAResetAreComparedWhenAskedFor) {
  DiffRequest all;
  all.all_takes = true;
  EXPECT_TRUE(diff(resetRun({0, 1, 2}, {0, 1}), resetRun({0, 1, 2}, {0, 1}), all).isSame());
  const RecordingDiff found = diff(resetRun({0, 1, 2}, {0, 1}), resetRun({0, 1}, {0, 1}), all);
  EXPECT_EQ(found.streams.at({"joint_command", "force"}).only_a, 1U);
  EXPECT_EQ(found.resets_before, (std::array<std::uint32_t, 2>{0, 0}));
}

TEST_F(BagDiff, WithoutTheTopicOfResetsATakeBeginsWhereTheStatesGoBack) {
  const auto states = [](const std::vector<std::uint64_t>& steps) {
    return [=](SmallRecording& out) {
      msg::PlantState state;
      for (const std::uint64_t step : steps) {
        state.step(step);
        out.add(dds::topics::kPlantState, "plant", state);
      }
    };
  };
  const auto left_out = [&](const std::vector<std::uint64_t>& steps) {
    return [=](SmallRecording& out) {
      states(steps)(out);
      out.attach("certificate.json", R"({"left_out": ["rewind"]})");
    };
  };
  const RecordingDiff found = diff(left_out({0, 1, 2, 0, 1, 0, 1, 2, 3}), states({0, 1, 2, 3}));
  EXPECT_TRUE(found.isSame());
  EXPECT_EQ(found.resets_before, (std::array<std::uint32_t, 2>{2, 0}));
}

TEST_F(BagDiff, TheSameStepTwiceIsPairedInItsOrder) {
  EXPECT_TRUE(diff(commands({0, 1, 1, 2}), commands({0, 1, 1, 2})).isSame());
  EXPECT_EQ(diff(commands({0, 1, 1, 2}), commands({0, 1, 2})).streams.at({"joint_command", "force"}).only_a, 1U);
}

TEST_F(BagDiff, AStreamThatOneDoesNotHaveIsADifference) {
  const auto both = [](SmallRecording& out) {
    commands({0, 1})(out);
    out.add(dds::topics::kShadowCommand, "pd", command(0, 0.0));
  };
  const RecordingDiff found = diff(commands({0, 1}), both);
  EXPECT_FALSE(found.isSame());
  EXPECT_EQ(found.streams.at({"shadow_command", "pd"}).only_b, 1U);
}

TEST_F(BagDiff, MessagesWithoutAStepAreComparedInTheirOrder) {
  const auto names = [](const std::vector<std::string>& values) {
    return [=](SmallRecording& out) {
      for (const std::string& value : values) {
        out.addBytes("names", "s", "S", "struct S { string name; };", test::Bytes().text(value).bytes);
      }
    };
  };
  const RecordingDiff found = diff(names({"a", "b", "c"}), names({"a", "x"}));
  const StreamDiff& stream = found.streams.at({"names", "s"});
  EXPECT_EQ(stream.compared, 2U);
  EXPECT_EQ(stream.different, 1U);
  EXPECT_EQ(stream.only_a, 1U);
  EXPECT_FALSE(stream.first->at.step);
  EXPECT_EQ(stream.first->at.index, 1U);
  EXPECT_EQ(stream.first->what.field, "name");
}

TEST_F(BagDiff, BytesWithoutATypeAreComparedAsTheyAre) {
  const auto bytes = [](const std::string& value) {
    return [=](SmallRecording& out) { out.addBytes("raw", "s", "T", "", mcap::asBytes(value)); };
  };
  EXPECT_TRUE(diff(bytes("abc"), bytes("abc")).isSame());
  const RecordingDiff found = diff(bytes("abcd"), bytes("abX"));
  EXPECT_EQ(found.streams.at({"raw", "s"}).first->what.field, "byte 2");
  EXPECT_EQ(found.streams.at({"raw", "s"}).first->what.a, "6364");
  EXPECT_EQ(found.streams.at({"raw", "s"}).first->what.b, "58");
}

TEST_F(BagDiff, OnlyTheLoopIsComparedUnlessOthersAreNamed) {
  const auto with = [](std::int32_t pid) {
    return [=](SmallRecording& out) {
      commands({0})(out);
      msg::ServiceStatus status;
      status.pid(pid);
      out.add(dds::topics::kServiceStatus, "plant", status);
    };
  };
  const RecordingDiff found = diff(with(1), with(2));
  EXPECT_TRUE(found.isSame());
  EXPECT_EQ(found.left_out, (std::vector<std::string>{"service_status"}));
  const RecordingDiff named = diff(with(1), with(2), {.topics = {"service_status"}});
  EXPECT_EQ(named.streams.at({"service_status", "plant"}).first->what.field, "pid");
  EXPECT_TRUE(diff(with(1), with(2), {.topics = {"service_status"}, .ignored = {"service_status.pid"}}).isSame());
  EXPECT_TRUE(diff(with(1), with(2), {.topics = {"service_status"}, .ignored = {"pid"}}).isSame());
  EXPECT_TRUE(
      diff(with(1), with(2), {.topics = {"service_status", "joint_command"}, .ignored = {"service_status"}}).isSame());
}

TEST_F(BagDiff, TolerancesHoldForTheFieldTheyName) {
  const auto a = commands({0, 1, 2});
  const auto b = commands({0, 1, 2}, 1.25, 1);
  EXPECT_FALSE(diff(a, b).isSame());
  EXPECT_TRUE(diff(a, b, {.tolerances = {"0.25"}}).isSame());
  EXPECT_FALSE(diff(a, b, {.tolerances = {"0.24"}}).isSame());
  EXPECT_TRUE(diff(a, b, {.tolerances = {"effort=0.25"}}).isSame());
  EXPECT_TRUE(diff(a, b, {.tolerances = {"joint_command.effort=0.3"}}).isSame());
  // What is said of a field in particular goes before what is said of all, in either order.
  EXPECT_FALSE(diff(a, b, {.tolerances = {"1", "effort=0.1"}}).isSame());
  EXPECT_TRUE(diff(a, b, {.tolerances = {"joint_command.effort=0.3", "effort=0.1"}}).isSame());
  EXPECT_FALSE(diff(a, b, {.tolerances = {"step=5"}}).isSame());
  EXPECT_TRUE(diff(a, b, {.tolerances = {"+0.25"}}).isSame());
  EXPECT_FALSE(diff(a, b, {.tolerances = {"1,effort=0.1"}}).isSame());
  EXPECT_TRUE(diff(a, b, {.tolerances = {"step=1e-9,0.3"}}).isSame());
}

TEST_F(BagDiff, ADecimalCommaIsNoListOfTolerances) {
  for (const char* list : {"0,5", "effort=0,5", "effort=1e-9,step=0,5", "effort=0,5e-3"}) {
    try {
      (void)RuleSet({}, {list});
      ADD_FAILURE() << list;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("; the decimal sign is a point: 0.5"), std::string::npos)
          << error.what();
    }
  }
}

TEST_F(BagDiff, RefusesRulesThatAreAboutNothing) {
  const auto a = commands({0});
  for (const DiffRequest& request :
       {DiffRequest{.topics = {"no_such"}}, DiffRequest{.ignored = {"no_such"}},
        DiffRequest{.ignored = {"joint_command.nothing"}}, DiffRequest{.tolerances = {"no_such=1"}},
        DiffRequest{.tolerances = {"effort=far"}}, DiffRequest{.tolerances = {"-1"}}, DiffRequest{.tolerances = {"=1"}},
        DiffRequest{.tolerances = {"nan"}}, DiffRequest{.ignored = {"joint_command"}}}) {
    EXPECT_THROW((void)diff(a, a, request), UsageError);
  }
  EXPECT_THROW((void)diff([](SmallRecording&) {}, [](SmallRecording&) {}), UsageError);
  try {
    (void)diff(a, a, {.ignored = {"joint_comand"}});
    ADD_FAILURE() << "expected a UsageError, found none";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("found 'joint_comand'; did you mean 'joint_command'?"), std::string::npos)
        << error.what();
  }
}

// --- two messages

struct Pair {
  Pair(const std::string& idl_a, const std::string& idl_b, const test::Bytes& a, const test::Bytes& b,
       const FieldRules& rules = {})
      : types_a(schema::parseIdl(idl_a)), types_b(schema::parseIdl(idl_b)) {
    found = compare({types_a.find("S"), a.bytes}, {types_b.find("S"), b.bytes}, rules);
  }
  schema::TypeSet types_a, types_b;
  std::optional<FieldDifference> found;
};

TEST(MessageDiff, NumbersAreTheSameBitByBit) {
  const auto different = [](auto a, auto b, const char* type) {
    const std::string idl = std::string("struct S { ") + type + " a; };";
    return Pair(idl, idl, test::Bytes().number(a), test::Bytes().number(b)).found.has_value();
  };
  EXPECT_FALSE(different(0.1, 0.1, "double"));
  EXPECT_TRUE(different(0.0, -0.0, "double"));
  EXPECT_TRUE(different(0.0F, -0.0F, "float"));
  EXPECT_FALSE(different(std::nan("1"), std::nan("1"), "double"));
}

TEST(MessageDiff, DistancesDoNotOverflow) {
  const auto within = [](auto a, auto b, const char* type, double allowed) {
    const std::string idl = std::string("struct S { ") + type + " a; };";
    FieldRules rules;
    rules.tolerate("", allowed);
    return !Pair(idl, idl, test::Bytes().number(a), test::Bytes().number(b), rules).found;
  };
  constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(within(kLeast, kMost, "long long", 1e19));
  EXPECT_TRUE(within(kLeast, kMost, "long long", 2e19));
  EXPECT_TRUE(within(std::uint64_t{3}, std::uint64_t{5}, "unsigned long long", 2.0));
  EXPECT_FALSE(within(std::uint64_t{3}, std::uint64_t{6}, "unsigned long long", 2.0));
  EXPECT_TRUE(within(std::nan("1"), std::nan("2"), "double", 0.0));
  EXPECT_FALSE(within(1.0, std::nan("2"), "double", 1e300));
  EXPECT_TRUE(within(HUGE_VAL, HUGE_VAL, "double", 0.0));
  EXPECT_FALSE(within(HUGE_VAL, 1.0, "double", 1e300));
}

TEST(MessageDiff, LengthsOfSequencesDiffer) {
  const std::string idl = "struct S { sequence<long> a; long b; };";
  const test::Bytes one = test::Bytes().number(std::uint32_t{1}).number(5).number(9);
  const test::Bytes two = test::Bytes().number(std::uint32_t{2}).number(5).number(6).number(9);
  const Pair pair(idl, idl, one, two);
  ASSERT_TRUE(pair.found);
  EXPECT_EQ(pair.found->field, "a");
  EXPECT_EQ(pair.found->a, "1 elements");
  EXPECT_EQ(pair.found->b, "2 elements");
  FieldRules rules;
  rules.ignore("a");
  EXPECT_FALSE(Pair(idl, idl, one, two, rules).found);
  const test::Bytes other = test::Bytes().number(std::uint32_t{2}).number(5).number(6).number(8);
  EXPECT_EQ(Pair(idl, idl, one, other, rules).found->field, "b");
}

TEST(MessageDiff, WhatIsDeclaredOtherwiseDiffers) {
  const test::Bytes a = test::Bytes().number(1), b = test::Bytes().number(2);
  EXPECT_TRUE(Pair("struct S { long a; };", "struct S { long b; };", a, b).found);
  const Pair longer("struct S { long a; };", "struct S { long a; long b; };", a, test::Bytes().number(1).number(2));
  ASSERT_TRUE(longer.found);
}

TEST(MessageDiff, TheSameValuesInOtherBytesAreNamedAsSuch) {
  const std::string idl = "struct S { octet a; long b; };";
  test::Bytes a = test::Bytes().number(std::uint8_t{1}).number(2);
  test::Bytes b = a;
  b.bytes[5] = std::byte{0xEE};  // between the members
  const Pair pair(idl, idl, a, b);
  ASSERT_TRUE(pair.found);
  EXPECT_EQ(pair.found->field, "");
  FieldRules rules;
  rules.tolerate("", 0.0);
  EXPECT_FALSE(Pair(idl, idl, a, b, rules).found);
}

}  // namespace
}  // namespace baton
