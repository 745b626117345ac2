#include "runtime/status_pace.hpp"

#include <gtest/gtest.h>

#include <string>

namespace baton {
namespace {

using Pace = StatusPace<std::string>;

TEST(StatusPace, WhatHasChangedIsDueAtOnce) {
  Pace pace;
  EXPECT_TRUE(pace.isDue("paused"));
  pace.wrote("paused");
  EXPECT_FALSE(pace.isDue("paused"));
  EXPECT_TRUE(pace.isDue("running"));
}

TEST(StatusPace, WhatHasNotIsDueAfterManyTicks) {
  Pace pace;
  pace.wrote("paused");
  for (int round = 0; round < 3; ++round) {
    for (int tick = 1; tick < Pace::kTicks; ++tick) EXPECT_FALSE(pace.isDue("paused")) << tick;
    EXPECT_TRUE(pace.isDue("paused"));
    pace.wrote("paused");
  }
}

TEST(StatusPace, WritingForAnotherReasonBeginsThePauseAnew) {
  Pace pace;
  pace.wrote("paused");
  for (int tick = 1; tick < Pace::kTicks; ++tick) EXPECT_FALSE(pace.isDue("paused"));
  pace.wrote("paused");
  EXPECT_FALSE(pace.isDue("paused"));
  EXPECT_EQ(pace.last(), "paused");
}

}  // namespace
}  // namespace baton
