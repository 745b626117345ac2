#include "failure_script.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

const std::vector<std::string> kNames{"a", "b", "c"};

std::vector<PlannedFailure> failures() {
  return {{.at_step = {}, .controller = "c", .returns_at_step = 300},
          {.at_step = 200, .controller = "a", .commanded = false, .returns_at_step = {}},
          {.at_step = 300, .controller = "b", .returns_at_step = 300, .restarted = true},
          {.at_step = 300, .controller = "c", .returns_at_step = {}}};
}

/// What takes effect up to a step, as text: "b- b+" for a failure and a return of b.
std::string upTo(FailureScript& script, std::uint64_t step) {
  std::string text;
  while (const auto event = script.next(step)) {
    text += (text.empty() ? "" : " ") + kNames[static_cast<std::size_t>(event->member)] + (event->returns ? "+" : "-");
  }
  return text;
}

TEST(FailureScript, GivesEachStepItsEventsInOrder) {
  FailureScript script(failures(), kNames);
  EXPECT_EQ(script.begin(0), std::vector<int>{2});
  EXPECT_EQ(upTo(script, 199), "");
  const auto first = script.next(200);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->member, 0);
  EXPECT_FALSE(first->returns || first->commanded);
  EXPECT_FALSE(script.next(200));
  // One that fails again in the step in which it returns has returned first.
  EXPECT_EQ(upTo(script, 300), "c+ b- b+ c-");
  EXPECT_EQ(upTo(script, 10'000), "");
}

TEST(FailureScript, ARunThatBeginsLaterHasTheEarlierOnesBehindIt) {
  FailureScript script(failures(), kNames);
  EXPECT_EQ(script.begin(250), (std::vector<int>{2, 0}));
  EXPECT_EQ(upTo(script, 300), "c+ b- b+ c-");
  EXPECT_EQ(script.begin(301), (std::vector<int>{0, 2}));
  EXPECT_EQ(upTo(script, 10'000), "");
}

TEST(FailureScript, BeginsAnewBehindAReset) {
  FailureScript script(failures(), kNames);
  EXPECT_EQ(script.begin(0), std::vector<int>{2});
  const std::string whole = upTo(script, 10'000);
  EXPECT_EQ(script.begin(0), std::vector<int>{2});
  EXPECT_EQ(upTo(script, 10'000), whole);
}

}  // namespace
}  // namespace baton
