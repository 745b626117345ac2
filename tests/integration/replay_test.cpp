// A recording, replayed: another reader gets the bytes that were recorded.
#include <gtest/gtest.h>

#include <map>
#include <mutex>

#include "dds/endpoint.hpp"
#include "dds/topics.hpp"
#include "support/processes.hpp"
#include "support/recordings.hpp"
#include "support/short_contact.hpp"

namespace baton::test {
namespace {

TEST(Replay, GivesAnotherReaderTheSameBytes) {
  Bench bench;
  const std::string file = (bench.folder() / "run.mcap").string();
  ASSERT_EQ(bench.baton({"run", bench.write("short.yaml", shortContact()), "--out", file}).exit_code, 0);

  // Listen first; the replayer waits for one reader on each topic.
  dds::Participant participant(
      {.domain = bench.domain(), .partition = "replay/test", .cell = "replay", .run = "test", .service = "listener"});
  std::mutex mutex;
  std::map<std::pair<std::string, dds::Guid>, std::vector<Payload>> received;
  std::vector<std::unique_ptr<dds::RawReader>> readers;
  const std::vector<std::pair<std::string, std::string>> topics{{"plant_state", "PlantState"},
                                                                {"contact", "Contact"},
                                                                {"reference", "Reference"},
                                                                {"joint_command", "JointCommand"},
                                                                {"shadow_command", "JointCommand"}};
  readers.reserve(topics.size());
  for (const auto& [topic, type] : topics) {
    readers.push_back(std::make_unique<dds::RawReader>(
        participant, dds::EndpointOptions{.topic = topic, .type = "baton::msg::" + type},
        [&received, &mutex, name = topic](const dds::RawSample& sample) {
          const std::lock_guard lock(mutex);
          received[{name, sample.writer}].emplace_back(sample.payload.begin(), sample.payload.end());
        }));
  }
  const Finished replay =
      bench.baton({"replay", file, "--cell", "replay", "--run", "test", "--rate", "max", "--wait-for", "1", "--topics",
                   "plant_state,contact,reference,joint_command,shadow_command"});
  ASSERT_EQ(replay.exit_code, 0) << replay.out << replay.err;

  // One recorded writer, one replayed writer: the same payloads in the same order.
  std::multimap<std::string, std::vector<Payload>> expected;
  for (auto& [key, payloads] : loopStreams(file)) expected.emplace(key.first, payloads);
  const std::lock_guard lock(mutex);
  ASSERT_EQ(received.size(), expected.size());
  for (const auto& [key, payloads] : received) {
    const auto [begin, end] = expected.equal_range(key.first);
    const bool is_there =
        std::any_of(begin, end, [&wanted = payloads](const auto& one) { return one.second == wanted; });
    EXPECT_TRUE(is_there) << key.first << ": " << payloads.size() << " samples";
  }
}

}  // namespace
}  // namespace baton::test
