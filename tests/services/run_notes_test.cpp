/// What a recording says in plain text of how its run went.
#include "run_notes.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace baton {
namespace {
using Json = nlohmann::json;

TEST(RunNotes, EventsAreListedAsTheyCame) {
  RunNotes notes;
  msg::Event event;
  event.step(7);
  event.severity(msg::SEVERITY_WARNING);
  event.service("plant");
  event.kind("late");
  event.text("waits for force");
  notes.add(event);
  const Json events = Json::parse(notes.events());
  ASSERT_EQ(events.at("events").size(), 1u);
  EXPECT_EQ(events.at("events").at(0).at("step"), 7);
  EXPECT_EQ(events.at("events").at(0).at("severity"), "warning");
  EXPECT_EQ(events.at("events").at(0).at("text"), "waits for force");
  EXPECT_EQ(events.at("not_listed"), 0);
}

TEST(RunNotes, AFloodOfEventsIsCounted) {
  RunNotes notes;
  for (std::size_t i = 0; i < RunNotes::kMaxEvents + 5; ++i) notes.add(msg::Event{});
  const Json events = Json::parse(notes.events());
  EXPECT_EQ(events.at("events").size(), RunNotes::kMaxEvents);
  EXPECT_EQ(events.at("not_listed"), 5);
}

TEST(RunNotes, OfParametersTheLatestCount) {
  RunNotes notes;
  msg::ParameterStatus status;
  status.name("soft");
  status.law("joint_pd");
  msg::Parameter kp, form, kd;
  kp.name("kp");
  kp.numbers({30.0});
  form.name("form");
  form.word("corrected");
  kd.name("kd");
  kd.numbers({1.0, 2.0});
  status.parameters({kp, form, kd});
  notes.add(status);
  kp.numbers({50.0});
  status.parameters({kp, form, kd});
  notes.add(status);
  const Json expected = {
      {"soft", {{"law", "joint_pd"}, {"parameters", {{"kp", 50.0}, {"form", "corrected"}, {"kd", {1.0, 2.0}}}}}}};
  EXPECT_EQ(Json::parse(notes.parameters()), expected);
}

}  // namespace
}  // namespace baton
