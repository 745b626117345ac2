/// What may be asked of a recorder when.
#include "control.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

constexpr msg::RecordAction kAll[]{msg::RECORD_START, msg::RECORD_STOP, msg::RECORD_PAUSE, msg::RECORD_RESUME,
                                   msg::RECORD_SNAPSHOT};

/// Those that are possible, as letters.
std::string possible(const RecordingControl& control) {
  std::string letters;
  for (const msg::RecordAction action : kAll) {
    if (control.objection(action).empty()) letters += "SEPRW"[static_cast<int>(action)];
  }
  return letters;
}

TEST(RecordingControl, WhatIsRecordedCanBeEndedOrPaused) {
  RecordingControl control(false, false);
  EXPECT_TRUE(control.keeps());
  EXPECT_EQ(possible(control), "EP");
  control.done(msg::RECORD_PAUSE);
  EXPECT_EQ(control.state(), msg::RECORDER_PAUSED);
  EXPECT_FALSE(control.keeps());
  EXPECT_TRUE(control.isOpen());
  EXPECT_EQ(possible(control), "ER");
  control.done(msg::RECORD_RESUME);
  EXPECT_TRUE(control.keeps());
  control.done(msg::RECORD_STOP);
  EXPECT_FALSE(control.isOpen());
  EXPECT_EQ(possible(control), "S");
}

TEST(RecordingControl, OneThatWaitsCanOnlyBeBegun) {
  RecordingControl control(false, true);
  EXPECT_EQ(control.state(), msg::RECORDER_STOPPED);
  EXPECT_EQ(possible(control), "S");
  control.done(msg::RECORD_START);
  EXPECT_TRUE(control.keeps());
}

TEST(RecordingControl, WhatEndedByItselfCanBeBegunAgain) {
  RecordingControl control(false, false);
  control.ended();
  EXPECT_EQ(possible(control), "S");
  control.done(msg::RECORD_START);
  control.failed();
  EXPECT_EQ(control.state(), msg::RECORDER_FAILED);
  EXPECT_EQ(possible(control), "S");
}

TEST(RecordingControl, ARingIsWrittenAndPausedButNotBegun) {
  RecordingControl control(true, false);
  EXPECT_EQ(possible(control), "PW");
  control.done(msg::RECORD_SNAPSHOT);
  EXPECT_TRUE(control.keeps()) << "it goes on";
  control.done(msg::RECORD_PAUSE);
  EXPECT_EQ(possible(control), "RW") << "what it holds can be written in a pause too";
}

TEST(RecordingControl, WhenTheRunIsOverNothingIsPossible) {
  RecordingControl control(true, false);
  control.closed();
  EXPECT_EQ(possible(control), "");
  EXPECT_EQ(control.objection(msg::RECORD_SNAPSHOT), "the run is over");
}

}  // namespace
}  // namespace baton
