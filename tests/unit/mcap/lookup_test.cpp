/// What is asked of many a recording: topics, values of a map, times from its beginning.
#include "mcap/lookup.hpp"

#include <limits>

#include "recording.hpp"

namespace baton::mcap {
namespace {

constexpr std::uint64_t kLatest = std::numeric_limits<std::uint64_t>::max();

class LookupTest : public testing::Test {
 protected:
  [[nodiscard]] Reader recordingFrom(std::uint64_t start_ns) const {
    const std::filesystem::path path = folder_.file(std::to_string(start_ns) + ".mcap");
    Writer writer(path);
    for (const char* topic : {"b", "a", "b"}) {
      writer.write(writer.addChannel(topic, "cdr", kNoSchema), 1, start_ns, start_ns, {});
    }
    writer.close();
    return Reader(path);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(LookupTest, AMapWithoutTheKeyHasAnEmptyValue) {
  EXPECT_EQ(valueOf({{"key", "value"}}, "key"), "value");
  EXPECT_EQ(valueOf({{"key", "value"}}, "other"), "");
}

TEST_F(LookupTest, TopicsAreSortedAndThereOnce) {
  EXPECT_EQ(topicNames(recordingFrom(0)), (std::vector<std::string>{"a", "b"}));
}

TEST_F(LookupTest, TimesCountFromTheFirstMessageAndEndWithTheClock) {
  const Reader reader = recordingFrom(2'000'000'000);
  EXPECT_EQ(logTimeAt(reader, 0.0), 2'000'000'000U);
  EXPECT_EQ(logTimeAt(reader, 1.5), 3'500'000'000U);
  EXPECT_EQ(logTimeAt(reader, std::numeric_limits<double>::infinity()), 9'000'000'002'000'000'000U);
  const Reader late = recordingFrom(kLatest - 1'000'000'000);
  EXPECT_EQ(logTimeAt(late, 1.0), kLatest);
  EXPECT_EQ(logTimeAt(late, 2.0), kLatest);
}

}  // namespace
}  // namespace baton::mcap
