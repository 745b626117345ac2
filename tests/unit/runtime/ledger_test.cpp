/// The recording's completeness certificate: what came held against what was sent.
#include <functional>
#include <random>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "ledger_bookings.hpp"
#include "runtime/service_options.hpp"

namespace baton::test {
namespace {

TEST_F(LedgerTest, ARunThatArrivedWholeIsComplete) {
  transmit(state_, 100);
  transmit(contact_, 100);
  EXPECT_FALSE(ledger_.isSettled());
  ledger_.addManifest(manifestOf("plant", {&state_, &status_}));  // status_ sent nothing
  ledger_.addManifest(manifestOf("environment", {&contact_}));
  EXPECT_TRUE(ledger_.isSettled());
  EXPECT_TRUE(ledger_.isVouchedFor());
  EXPECT_TRUE(ledger_.isComplete());
  EXPECT_TRUE(ledger_.problems().empty());
  EXPECT_EQ(ledger_.missing(), 0u);
  const Json text = certificate();
  EXPECT_EQ(text["complete"], true);
  EXPECT_TRUE(text["problems"].empty());
  ASSERT_EQ(text["streams"].size(), 2u);
  for (const Json& row : text["streams"]) {
    const bool is_state = row["topic"] == "plant_state";
    EXPECT_EQ(row["writer"], dds::toString(is_state ? state_.guid : contact_.guid));
    EXPECT_EQ(row["first_sequence"], 1u);
    EXPECT_EQ(row["last_sequence"], 100u);
    EXPECT_EQ(row["count"], 100u);
    EXPECT_EQ(row["missing"], 0u);
    EXPECT_EQ(row["service"], is_state ? "plant" : "environment");
    EXPECT_EQ(row["sent"], 100u);
    EXPECT_EQ(row["stream_hash"], std::to_string(is_state ? state_.hash : contact_.hash));
    EXPECT_EQ(row["sent_hash"], row["stream_hash"]);
  }
}

TEST_F(LedgerTest, SamplesInTheMiddleThatNeverCameAreCounted) {
  transmit(state_, 100, [](std::uint64_t sequence) { return sequence != 7 && (sequence < 50 || sequence > 59); });
  EXPECT_EQ(ledger_.missing(), 11u);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  EXPECT_FALSE(ledger_.isComplete());
  EXPECT_TRUE(mentions(ledger_.problems(), "plant_state of plant: 100 samples sent, 89 recorded"));
  EXPECT_EQ(certificate()["streams"][0]["missing"], 11u);
}

TEST_F(LedgerTest, SamplesAtTheEndsThatNeverCameAreNoticedByTheManifest) {
  transmit(state_, 20, [](std::uint64_t sequence) { return sequence > 3 && sequence < 19; });
  EXPECT_EQ(ledger_.missing(), 0u) << "no hole between the first and the last that came";
  ledger_.addManifest(manifestOf("plant", {&state_}));
  EXPECT_TRUE(mentions(ledger_.problems(), "20 samples sent, 15 recorded"));
  EXPECT_FALSE(ledger_.isSettled()) << "they may still come";
}

TEST_F(LedgerTest, AStreamNobodyHeardOfIsMissingAltogether) {
  for (int i = 0; i < 5; ++i) state_.send();
  ledger_.addManifest(manifestOf("plant", {&state_}));
  EXPECT_TRUE(mentions(ledger_.problems(), "5 samples sent, 0 recorded"));
}

TEST_F(LedgerTest, DuplicatesAreNotBookedAgain) {
  transmit(state_, 10);
  for (std::uint64_t sequence = 1; sequence <= 10; ++sequence) {
    EXPECT_FALSE(ledger_.book(state_.key(), sequence, payloadOf(sequence)));
  }
  transmit(state_, 1);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(ledger_.isComplete());
  EXPECT_EQ(certificate()["streams"][0]["count"], 11u);
}

TEST_F(LedgerTest, OtherBytesThanThoseSentAreNoticed) {
  transmit(state_, 10);
  std::vector<std::byte> payload = state_.send();
  payload[0] ^= std::byte{1};
  EXPECT_TRUE(ledger_.book(state_.key(), 11, payload));
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(mentions(ledger_.problems(), "plant_state of plant: the recorded bytes are not those sent"));
  EXPECT_FALSE(ledger_.isComplete());
  EXPECT_EQ(certificate()["complete"], false);
}

TEST_F(LedgerTest, WritersOfOneTopicAreSeparateStreams) {
  Sender first{"joint_command", guidOf(7)}, second{"joint_command", guidOf(8)};
  std::mt19937 generator(60);
  for (int i = 0; i < 200; ++i) transmit(generator() % 2 == 0 ? first : second, 1);
  ledger_.addManifest(manifestOf("plant", {&first}));
  ledger_.addManifest(manifestOf("environment", {&second}));
  EXPECT_TRUE(ledger_.isComplete());
  EXPECT_EQ(certificate()["streams"].size(), 2u);
}

TEST_F(LedgerTest, AManifestThatNeverCameIsAProblem) {
  transmit(state_, 10);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  EXPECT_FALSE(ledger_.isSettled());
  EXPECT_TRUE(mentions(ledger_.problems(), "environment sent no manifest"));
  EXPECT_EQ(ledger_.problems().size(), 1u);
}

TEST_F(LedgerTest, AServiceThatFailedIsNotWaitedForButStillMissed) {
  transmit(state_, 10);
  ledger_.giveUpOn("environment");
  EXPECT_FALSE(ledger_.isSettled()) << "the plant's manifest can still come";
  ledger_.addManifest(manifestOf("plant", {&state_}));
  EXPECT_TRUE(ledger_.isSettled());
  EXPECT_FALSE(ledger_.isComplete());
  EXPECT_TRUE(mentions(ledger_.problems(), "environment sent no manifest"));
}

TEST_F(LedgerTest, AManifestMayComeBeforeTheLastSamples) {
  std::vector<std::vector<std::byte>> payloads;
  payloads.reserve(10);
  for (int i = 0; i < 10; ++i) payloads.push_back(state_.send());
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {}));
  for (std::uint64_t i = 0; i < 10; ++i) {
    EXPECT_FALSE(ledger_.isSettled());
    ledger_.book(state_.key(), i + 1, payloads[i]);
  }
  EXPECT_TRUE(ledger_.isSettled());
  EXPECT_TRUE(ledger_.isComplete());
}

TEST_F(LedgerTest, WritersOutsideTheRunAreRecordedWithoutAnAccount) {
  Sender foreign{"turtle/pose", guidOf(9)};
  transmit(foreign, 5);
  ledger_.addManifest(manifestOf("plant", {}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(ledger_.isComplete());
  const Json row = certificate()["streams"][0];
  EXPECT_EQ(row["topic"], "turtle/pose");
  EXPECT_FALSE(row.contains("sent"));
}

template <class T>
std::vector<std::byte> encoded(const T& message) {
  std::vector<std::byte> buffer(dds::maxPayload<T>());
  const auto payload = dds::encode(message, buffer);
  return {payload.begin(), payload.end()};
}

TEST_F(LedgerTest, WhatServicesSayIsReadFromWhatIsBooked) {
  transmit(state_, 10);
  const Ledger::Key manifests{dds::topics::kServiceManifest.name, guidOf(4)};
  const Ledger::Key status{dds::topics::kServiceStatus.name, guidOf(5)};
  ledger_.book(manifests, 1, encoded(manifestOf("plant", {&state_})));
  ledger_.book(manifests, 2, encoded(manifestOf("environment", {})));
  EXPECT_TRUE(ledger_.isComplete());
  EXPECT_EQ(ledger_.servicesHeard(), 2u);
  ledger_.book(manifests, 3, encoded(manifestOf("environment", {})));
  EXPECT_EQ(ledger_.servicesHeard(), 2u) << "started again, or a second copy: one service";

  msg::ServiceStatus joined;
  joined.name("late");
  joined.role("controller");
  joined.state(msg::SERVICE_READY);
  ledger_.book(status, 1, encoded(joined));
  EXPECT_TRUE(mentions(ledger_.problems(), "late sent no manifest"));
  EXPECT_FALSE(ledger_.isSettled());
  joined.state(msg::SERVICE_FAILED);
  ledger_.book(status, 2, encoded(joined));
  EXPECT_TRUE(ledger_.isSettled()) << "it will not come";
  EXPECT_FALSE(ledger_.isComplete());
}

TEST_F(LedgerTest, ARequestThatNeverCameLeavesTheRecordingComplete) {
  Sender requests{"swap_request", guidOf(9)}, outcomes{"swap_outcome", guidOf(10)};
  const auto butTheFourth = [](std::uint64_t sequence) { return sequence != 4; };
  transmit(state_, 10);
  transmit(contact_, 10);
  transmit(requests, 10, butTheFourth);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {&contact_}));
  EXPECT_TRUE(ledger_.isComplete());
  transmit(outcomes, 10, butTheFourth);
  EXPECT_TRUE(mentions(ledger_.problems(), "swap_outcome")) << "the consequences of requests must be there";
}

TEST_F(LedgerTest, ASecondCopySpeaksForItsOwnSamplesAndForNoService) {
  transmit(state_, 10);
  Sender second{"contact", guidOf(9)};
  transmit(contact_, 10);
  transmit(second, 2);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf(kSecondCopyName, {&second}));
  EXPECT_FALSE(ledger_.isSettled()) << "the environment's own is still to come";
  EXPECT_TRUE(mentions(ledger_.problems(), "environment sent no manifest"));
  EXPECT_EQ(ledger_.servicesHeard(), 1U);
  ledger_.addManifest(manifestOf("environment", {&contact_}));
  EXPECT_TRUE(ledger_.isComplete()) << ledger_.problems().front();
  EXPECT_EQ(ledger_.servicesHeard(), 2U);
}

TEST_F(LedgerTest, AgreesWithItsOwnCertificateAndWithNoOther) {
  transmit(state_, 10);
  transmit(contact_, 10, [](std::uint64_t sequence) { return sequence != 4; });
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {&contact_}));
  EXPECT_TRUE(ledger_.compare(ledger_.certificate()).disagreements.empty());

  const auto disagreementsWith = [&](const std::function<void(Json&)>& change) {
    Json text = certificate();
    change(text);
    return ledger_.compare(text.dump()).disagreements;
  };
  EXPECT_TRUE(
      mentions(disagreementsWith([](Json& text) { text["complete"] = true; }), "says complete, the bytes do not"));
  const Json rows = certificate()["streams"];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [field, value] : rows[i].items()) {
      const std::string name = field;
      EXPECT_FALSE(disagreementsWith([&](Json& text) { text["streams"][i][name] = "other"; }).empty()) << name;
      EXPECT_FALSE(disagreementsWith([&](Json& text) { text["streams"][i].erase(name); }).empty()) << name;
    }
    EXPECT_TRUE(mentions(disagreementsWith([&](Json& text) { text["streams"].erase(i); }), "does not know"));
    const std::uint64_t first = rows[i]["first_sequence"];
    const auto lostBefore = [&](std::uint64_t lost) {
      return disagreementsWith([&](Json& text) { text["streams"][i]["lost_before"] = lost; });
    };
    EXPECT_TRUE(mentions(lostBefore(first), "more was lost before its first sample than there was"));
    EXPECT_TRUE(lostBefore(first - 1).empty());
  }
  EXPECT_TRUE(mentions(disagreementsWith([&](Json& text) {
                         text["streams"].push_back(rows[0]);
                         text["streams"].back()["topic"] = "more";
                       }),
                       "knows more of writer"));
  for (const char* text : {"", "{", "[]", "{}", R"({"complete": 1, "streams": []})", R"({"streams": [1]})"}) {
    EXPECT_FALSE(ledger_.compare(text).disagreements.empty()) << text;
  }
}

TEST_F(LedgerTest, WhatACertificateSaysIsNotInTheFilesOnPurposeIsNotMissedThere) {
  // Of 100 samples 31 to 60 are in the files, but for a pause from 41 to 50; the others came, and were vouched for.
  std::uint64_t whole_hash = 0;
  for (std::uint64_t sequence = 1; sequence <= 100; ++sequence) {
    const std::vector<std::byte> payload = state_.send();
    whole_hash = dds::chainHash(whole_hash, payload);
    if (sequence > 30 && sequence <= 60 && (sequence <= 40 || sequence > 50)) {
      ledger_.book(state_.key(), sequence, payload);
    }
  }
  for (int i = 0; i < 7; ++i) contact_.send();
  ledger_.addManifest(manifestOf("plant", {&state_, &contact_}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_FALSE(ledger_.isComplete());

  Json told = certificate();
  Json& row = told["streams"][0];
  row["missing"] = 0;
  row["left_out"] = 10;
  row["received"] = 100;
  row["received_hash"] = std::to_string(whole_hash);
  told["left_out"] = {"contact"};
  told["complete"] = true;
  Ledger other = ledger_;
  other.excuse(told.dump());
  EXPECT_TRUE(other.isComplete()) << other.problems().front();
  EXPECT_TRUE(other.compare(told.dump()).disagreements.empty());

  // But what it says came has to be what was sent,
  Json less = told;
  less["streams"][0]["received"] = 99;
  other = ledger_;
  other.excuse(less.dump());
  EXPECT_TRUE(mentions(other.problems(), "100 samples sent, 99 recorded"));
  // and what it does not excuse is missed.
  less = told;
  less["streams"][0]["left_out"] = 9;
  other = ledger_;
  other.excuse(less.dump());
  EXPECT_FALSE(other.compare(less.dump()).disagreements.empty());
  for (const char* text : {"", "{", "[]", "{}", R"({"left_out": 1})", R"({"streams": [1]})", R"({"run_is_over": 3})"}) {
    other = ledger_;
    other.excuse(text);
    EXPECT_FALSE(other.isComplete()) << text;
  }
}

TEST_F(LedgerTest, AnExcerptIsHeldAgainstItsCertificateAlone) {
  transmit(state_, 10);
  EXPECT_FALSE(ledger_.isComplete()) << "nobody says what was sent";
  ledger_.excuse(R"({"run_is_over": false, "streams": []})");
  EXPECT_TRUE(ledger_.isComplete());
}

TEST_F(LedgerTest, ASumBeginsWhereTheFilesDo) {
  Ledger later({});
  for (std::uint64_t sequence = 1; sequence <= 20; ++sequence) {
    const std::vector<std::byte> payload = state_.send();
    ledger_.book(state_.key(), sequence, payload);
    if (sequence == 10) {
      const Json seed = {{"streams",
                          {{{"topic", "plant_state"},
                            {"writer", dds::toString(state_.guid)},
                            {"hash_seed", std::to_string(state_.hash)}}}}};
      later.beginAt(seed.dump());
    } else if (sequence > 10) {
      later.book(state_.key(), sequence, payload);
    }
  }
  EXPECT_EQ(later.streams().at(state_.key()).stream_hash, state_.hash);
}

TEST_F(LedgerTest, ATopicThatIsLeftOutIsNotMissed) {
  transmit(state_, 10);
  for (int i = 0; i < 5; ++i) contact_.send();
  ledger_.leaveOut("contact");
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {&contact_}));
  EXPECT_TRUE(ledger_.isSettled());
  EXPECT_TRUE(ledger_.isComplete());
}

TEST_F(LedgerTest, InTheMiddleOfARunOnlyGapsAreProblems) {
  transmit(state_, 10);
  EXPECT_TRUE(ledger_.problemsSoFar().empty()) << "nobody has said yet what was sent";
  EXPECT_FALSE(ledger_.isComplete());
  transmit(state_, 10, [](std::uint64_t sequence) { return sequence > 12; });
  transmit(status_, 10, [](std::uint64_t sequence) { return sequence == 10; });
  ASSERT_EQ(ledger_.problemsSoFar().size(), 1u);
  EXPECT_TRUE(mentions(ledger_.problemsSoFar(), "plant_state of " + dds::toString(state_.guid) + ": 2 samples"));
}

TEST_F(LedgerTest, WhatFoundNoRoomIsCountedOnceAndListed) {
  transmit(state_, 10);
  Ledger::Stream& stream = ledger_.streamOf(state_.key());
  for (int i = 0; i < 5; ++i) state_.send();
  ledger_.dropped(stream, 11, 15);
  transmit(state_, 1);
  EXPECT_EQ(ledger_.missing(), 5u);
  ASSERT_EQ(ledger_.gaps().size(), 1u);
  EXPECT_EQ(ledger_.gaps()[0].first_sequence, 11u);
  EXPECT_EQ(ledger_.gaps()[0].last_sequence, 15u);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(mentions(ledger_.problems(), "16 samples sent, 11 recorded"));
  EXPECT_TRUE(mentions(ledger_.problems(), "5 samples came faster than they could be written"));
}

TEST_F(LedgerTest, WhatWasLostBeforeTheFileBeganIsExcusedAndNothingElse) {
  transmit(state_, 10);
  Ledger::Stream& stream = ledger_.streamOf(state_.key());
  for (int i = 0; i < 5; ++i) state_.send();
  ledger_.dropped(stream, 11, 15);
  transmit(state_, 5);
  EXPECT_EQ(ledger_.problemsSoFar().size(), 2u);
  stream.second.excused = 5;
  EXPECT_TRUE(ledger_.problemsSoFar().empty());
  EXPECT_EQ(ledger_.missing(), 5u) << "of the run";
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(ledger_.isComplete()) << ledger_.problems()[0];
  stream.second.excused = 4;
  EXPECT_TRUE(mentions(ledger_.problems(), "20 samples sent, 15 recorded"));
}

TEST_F(LedgerTest, WhatWasSentBeforeTheFirstThatCameCanBeExcusedAsWell) {
  transmit(state_, 20, [](std::uint64_t sequence) { return sequence > 8 && sequence != 12; });
  Ledger::Stream& stream = ledger_.streamOf(state_.key());
  EXPECT_EQ(ledger_.missing(), 1u) << "samples 1 to 8 may have been sent before the recorder was matched";
  EXPECT_EQ(stream.second.neverRecorded(), 9u);
  ledger_.addManifest(manifestOf("plant", {&state_}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(mentions(ledger_.problems(), "20 samples sent, 11 recorded"));
  stream.second.excused = stream.second.neverRecorded();
  EXPECT_TRUE(ledger_.isComplete()) << ledger_.problems()[0];
}

TEST_F(LedgerTest, WhatFoundNoRoomBeforeTheFirstIsMissingToo) {
  ledger_.dropped(ledger_.streamOf(state_.key()), 1, 4);
  for (int i = 0; i < 4; ++i) state_.send();
  transmit(state_, 1);
  EXPECT_EQ(ledger_.missing(), 4u);
  EXPECT_EQ(certificate()["streams"][0]["first_sequence"], 1u);
  EXPECT_EQ(certificate()["streams"][0]["count"], 1u);
}

TEST_F(LedgerTest, GapsOfAWriterNobodyVouchesForAreProblems) {
  Sender foreign{"turtle/pose", guidOf(9)};
  transmit(foreign, 5, [](std::uint64_t sequence) { return sequence != 3; });
  ledger_.addManifest(manifestOf("plant", {}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(mentions(ledger_.problems(), "turtle/pose"));
}

TEST_F(LedgerTest, TheWordOfOneThatNobodyWaitsForMayStillCome) {
  Sender event_of_plant{"event", guidOf(7)}, event_of_another{"event", guidOf(8)};
  transmit(event_of_plant, 2);
  transmit(event_of_another, 1);
  ledger_.addManifest(manifestOf("plant", {&event_of_plant}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(ledger_.isSettled());
  EXPECT_FALSE(ledger_.isVouchedFor());
  ledger_.addManifest(manifestOf("supervisor", {&event_of_another}));
  EXPECT_TRUE(ledger_.isVouchedFor());
  EXPECT_TRUE(ledger_.isComplete());
}

TEST_F(LedgerTest, WhatCannotBeRecordedIsAProblem) {
  ledger_.addManifest(manifestOf("plant", {}));
  ledger_.addManifest(manifestOf("environment", {}));
  EXPECT_TRUE(ledger_.isComplete());
  ledger_.cannotRecord("plant_state", "a writer of another type");
  EXPECT_TRUE(mentions(ledger_.problems(), "a writer of another type"));
  EXPECT_TRUE(mentions(ledger_.problemsSoFar(), "a writer of another type"));
  ledger_.remarkForeignTopics();
  ledger_.cannotRecord("nothing came");
  EXPECT_TRUE(mentions(ledger_.problems(), "nothing came")) << "of no topic: it is not a foreign one's";
  EXPECT_TRUE(ledger_.remarks().empty());
}

TEST_F(LedgerTest, TheCertificateIsWrittenWhateverBytesAForeignNameHas) {
  Sender foreign{"caf\xE9\x01\"", guidOf(9)};
  transmit(foreign, 1);
  EXPECT_EQ(certificate()["streams"].size(), 1u);
}

}  // namespace
}  // namespace baton::test
