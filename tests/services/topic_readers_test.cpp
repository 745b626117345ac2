/// The recorder's readers: made as writers of foreign topics appear, as many as there is room for.
#include "discovery.hpp"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <map>
#include <mutex>
#include <vector>

#include "dds/topics.hpp"
#include "support/own_domain.hpp"

namespace baton::test {
namespace {

dds::ParticipantOptions memberOptions(const std::string& service) {
  return {.domain = ownDomain(), .partition = "readers", .cell = "readers", .run = "run", .service = service};
}

class TopicReadersTest : public testing::Test {
 protected:
  /// Serves the readers until it is so; returns whether it came to be.
  template <class Condition>
  [[nodiscard]] bool eventually(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!condition() && std::chrono::steady_clock::now() < end) {
      executor_.restart();
      executor_.run_for(std::chrono::milliseconds(5));
    }
    return condition();
  }
  [[nodiscard]] std::size_t receivedFrom(const dds::RawWriter& writer) {
    const std::lock_guard lock(mutex_);
    return received_[writer.guid()];
  }
  [[nodiscard]] ReadingRules rules() {
    ReadingRules rules;
    rules.is_wanted = [](const dds::DiscoveredWriter&) { return true; };
    rules.on_unreadable = [this](const std::string& text) { told_.push_back(text); };
    return rules;
  }
  TopicReaders::Sink sink() {
    return [this](std::uint32_t, bool, const dds::RawSample& sample) {
      const std::lock_guard lock(mutex_);
      ++received_[sample.writer];
    };
  }

  boost::asio::io_context executor_;
  std::mutex mutex_;
  std::map<dds::Guid, std::size_t> received_;
  std::vector<std::string> told_;
  dds::Participant recorder_{memberOptions("recorder")};
  dds::Participant talker_{memberOptions("talker")};
  const std::vector<std::byte> payload_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{7}};
};

TEST_F(TopicReadersTest, NoMoreWritersOfForeignTopicsAreReadThanThereIsRoomFor) {
  ReadingRules only_one = rules();
  only_one.max_foreign_writers = 1;
  TopicReaders readers(recorder_, executor_, only_one, sink());
  readers.watch();
  const dds::EndpointOptions endpoint{.topic = "theirs", .type = "test::T"};
  dds::RawWriter first(talker_, endpoint);
  ASSERT_TRUE(eventually([&] { return !first.matched().empty(); }));
  ASSERT_TRUE(first.write(payload_));
  ASSERT_TRUE(eventually([&] { return receivedFrom(first) == 1; }));
  // The reader is there, and DDS matches it with any writer.
  dds::RawWriter second(talker_, endpoint);
  ASSERT_TRUE(eventually([&] { return !second.matched().empty() && !told_.empty(); }));
  ASSERT_TRUE(second.write(payload_));
  ASSERT_TRUE(second.waitForAcknowledgments(30'000));
  ASSERT_TRUE(first.write(payload_));
  ASSERT_TRUE(eventually([&] { return receivedFrom(first) == 2; }));
  EXPECT_EQ(receivedFrom(second), 0U);
  ASSERT_EQ(readers.unreadable().size(), 1U);
  EXPECT_NE(told_[0].find("only the first 1 writers"), std::string::npos) << told_[0];
  EXPECT_EQ(readers.unreadable()[0].text, told_[0]);
}

TEST_F(TopicReadersTest, ForeignTopicsThatAreNotWantedHaveNoReader) {
  ReadingRules own = rules();
  own.selection.takes_foreign = false;
  TopicReaders readers(recorder_, executor_, own, sink());
  readers.watch();
  dds::RawWriter foreign(talker_, {.topic = "theirs", .type = "test::T"});
  dds::RawWriter known(talker_, {.topic = dds::topics::kEvent.name, .type = dds::topics::kEvent.type});
  ASSERT_TRUE(eventually([&] { return !known.matched().empty(); })) << "which was found after the other one";
  EXPECT_TRUE(foreign.matched().empty());
  EXPECT_TRUE(readers.leftOut().empty()) << "strangers do not write what the certificate says";
}

}  // namespace
}  // namespace baton::test
