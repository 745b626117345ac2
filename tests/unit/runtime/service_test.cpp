#include "runtime/service.hpp"

#include <gtest/gtest.h>

#include "dds/topics.hpp"

namespace baton {
namespace {

TEST(LossText, NamesWhatWasLost) {
  EXPECT_EQ(lossText(dds::topics::kContact, 0, 0, 0), "");
  EXPECT_EQ(lossText(dds::topics::kContact, 3, 0, 0), "contact: 3 samples lost on the way");
  EXPECT_EQ(lossText(dds::topics::kEvent, 1, 2, 4),
            "event: 1 sample lost on the way, 2 that could not be read, 4 of strangers, not heard");
}

TEST(LossText, AStatusThatWasReplacedIsNotLost) {
  for (const dds::TopicFacts& topic : dds::topics::kAll) {
    EXPECT_EQ(lossText(topic, 5, 0, 0).empty(), dds::isStatusTopic(topic.name)) << topic.name;
  }
  EXPECT_EQ(lossText(dds::topics::kServiceStatus, 5, 1, 0), "service_status: 1 that could not be read");
}

}  // namespace
}  // namespace baton
