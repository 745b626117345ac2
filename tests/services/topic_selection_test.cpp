/// Which topics a recording is to hold.
#include "topic_selection.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

TEST(TopicSelection, WithoutPatternsAllAreRecorded) {
  EXPECT_TRUE(TopicSelection{}.isRecorded("plant_state"));
  EXPECT_TRUE(TopicSelection{}.isRecorded("rt/turtle/pose"));
}

TEST(TopicSelection, AllowsWhatAPatternNames) {
  const TopicSelection selection{{"plant_*", "contact"}, {}};
  EXPECT_TRUE(selection.isRecorded("plant_state"));
  EXPECT_TRUE(selection.isRecorded("plant_state_again"));
  EXPECT_TRUE(selection.isRecorded("contact"));
  EXPECT_FALSE(selection.isRecorded("contacts")) << "the whole name";
  EXPECT_FALSE(selection.isRecorded("reference"));
}

TEST(TopicSelection, TakesAwayFromWhatIsAllowed) {
  const TopicSelection selection{{"*_status", "plant_state*"}, {"*_again", "sim_statu?"}};
  EXPECT_TRUE(selection.isRecorded("plant_state"));
  EXPECT_FALSE(selection.isRecorded("plant_state_again"));
  EXPECT_TRUE(selection.isRecorded("baton_status"));
  EXPECT_FALSE(selection.isRecorded("sim_status"));
}

TEST(TopicSelection, LeavesOutForeignTopicsWhereTheyAreNotWanted) {
  const TopicSelection own{.topics = {"plant_*", "rt/*"}, .except = {}, .takes_foreign = false};
  EXPECT_TRUE(own.isRecorded("plant_state"));
  EXPECT_FALSE(own.isRecorded("rt/turtle/pose"));
  EXPECT_FALSE(own.isRecorded("plant_temperature")) << "none of Baton's, whatever it is called";
  EXPECT_EQ(own.unmatched({"plant_state", "rt/turtle/pose"}), std::vector<std::string>{"rt/*"});
}

TEST(TopicSelection, APatternReachesOverSlashes) {
  EXPECT_FALSE((TopicSelection{{}, {"rt/*"}}.isRecorded("rt/turtle/pose")));
}

TEST(TopicSelection, TellsWhichPatternsMatchNothing) {
  const TopicSelection selection{{"plant_*", "contcat"}, {"*_status", "refrence"}};
  EXPECT_EQ(selection.unmatched({"plant_state", "contact", "sim_status"}), std::vector<std::string>{"contcat"});
  EXPECT_TRUE(TopicSelection{}.unmatched({"contact"}).empty());
}

}  // namespace
}  // namespace baton
