/// What is lost of topics that are none of Baton's, in the account of a run.
#include "ledger_bookings.hpp"

namespace baton::test {
namespace {

class LedgerRemarksTest : public LedgerTest {};

TEST_F(LedgerRemarksTest, WhatIsLostOnForeignTopicsIsRemarkedInTheAccountOfARun) {
  Sender foreign{"their_topic", guidOf(9)};
  ledger_.addManifest(manifestOf("plant", {}));
  ledger_.addManifest(manifestOf("environment", {}));
  transmit(foreign, 10, [](std::uint64_t sequence) { return sequence != 5; });
  ledger_.dropped(ledger_.streamOf(foreign.key()), 11, 13);
  ledger_.cannotRecord("their_topic", "a writer of another type");
  EXPECT_EQ(ledger_.problems().size(), 3u) << "of traffic without a run, nothing is more than anything else";
  EXPECT_TRUE(ledger_.remarks().empty());
  ledger_.remarkForeignTopics();
  EXPECT_TRUE(ledger_.isComplete());
  EXPECT_TRUE(ledger_.problemsSoFar().empty());
  EXPECT_EQ(ledger_.missing(), 0u);
  ASSERT_EQ(ledger_.remarks().size(), 2u);
  EXPECT_TRUE(mentions(ledger_.remarks(), "a writer of another type"));
  EXPECT_TRUE(mentions(ledger_.remarks(), "their_topic of " + dds::toString(foreign.guid) + ": 4 samples"));
  transmit(contact_, 3, [](std::uint64_t sequence) { return sequence != 2; });
  EXPECT_TRUE(mentions(ledger_.problems(), "contact of ")) << "the run's own are judged as before";
  EXPECT_EQ(ledger_.remarks().size(), 2u);
}

TEST_F(LedgerRemarksTest, ACertificateThatSaysOtherwiseOfAForeignTopicIsRemarked) {
  Sender foreign{"their_topic", guidOf(9)};
  transmit(foreign, 3);
  transmit(contact_, 3);
  ledger_.remarkForeignTopics();
  Json other = certificate();
  other["complete"] = false;
  other["remarks"] = {"half of it is elsewhere"};
  for (Json& row : other["streams"]) row["count"] = 2;
  const Ledger::Comparison comparison = ledger_.compare(other.dump());
  ASSERT_EQ(comparison.disagreements.size(), 1u);
  EXPECT_TRUE(mentions(comparison.disagreements, "contact of writer"));
  ASSERT_EQ(comparison.remarks.size(), 2u);
  EXPECT_EQ(comparison.remarks[0], "half of it is elsewhere");
  EXPECT_TRUE(mentions(comparison.remarks, "their_topic of writer"));
  other["remarks"] = 5;
  EXPECT_TRUE(mentions(ledger_.compare(other.dump()).disagreements, "cannot be read"));
}

}  // namespace
}  // namespace baton::test
