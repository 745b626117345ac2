/// Several files read as one.
#include "mcap/joined_reader.hpp"

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "recording.hpp"

namespace baton::mcap {
namespace {

using Order = MessageFilter::Order;

class JoinedReaderTest : public testing::Test {
 protected:
  struct Sample {
    std::string topic;
    std::uint64_t time_ns;
    std::uint32_t sequence;
    std::uint64_t publish_time_ns = 0;  // 0: that of the log
  };
  /// A file with a channel a topic, in the order of `topics`; the first `repeated` samples are from before.
  std::filesystem::path write(const std::string& name, const std::vector<std::string>& topics,
                              const std::vector<Sample>& samples, std::uint64_t repeated = 0) {
    std::filesystem::path path = folder_.file(name);
    Writer writer(path);
    if (repeated > 0) writer.addMetadata(kRepeatedRecord, repeatedRecord(repeated));
    writer.addMetadata("about", {{"file", name}});
    writer.addAttachment("name.txt", "text/plain", 0, 0, asBytes(name));
    std::map<std::string, ChannelId> channels;
    for (const std::string& topic : topics) {
      const SchemaId schema = writer.addSchema("S" + topic, "text", asBytes(topic));
      channels[topic] = writer.addChannel(topic, "cdr", schema, {{"writer", topic}});
    }
    for (const Sample& one : samples) {
      const std::uint64_t publish_time_ns = one.publish_time_ns == 0 ? one.time_ns : one.publish_time_ns;
      writer.write(channels.at(one.topic), one.sequence, one.time_ns, publish_time_ns, asBytes(name));
    }
    writer.close();
    return path;
  }
  /// Topics and sequence numbers in the order of a pass.
  static std::vector<std::string> read(const Source& reader, const MessageFilter& filter = {}) {
    std::vector<std::string> found;
    reader.forEachMessage(filter, [&](const MessageView& message) {
      EXPECT_EQ(message.schema->name, "S" + message.channel->topic);
      EXPECT_EQ(&reader.channels().at(message.channel->id), message.channel);
      found.push_back(message.channel->topic + std::to_string(message.sequence));
    });
    return found;
  }
  static FileList files(std::vector<std::filesystem::path> paths) { return FileList(std::move(paths)); }

  using Texts = std::vector<std::string>;
  TemporaryFolder folder_;
};

TEST_F(JoinedReaderTest, OneFileIsReadAsItIs) {
  const JoinedReader reader(write("a.mcap", {"x", "y"}, {{"y", 10, 1}, {"x", 20, 1}}));
  EXPECT_EQ(read(reader), (Texts{"y1", "x1"}));
  EXPECT_EQ(reader.statistics().message_count, 2U);
  EXPECT_TRUE(reader.info().is_complete);
}

TEST_F(JoinedReaderTest, ChannelsThatAreTheSameAreOneWhateverTheirNumbers) {
  const JoinedReader reader(files({write("a.mcap", {"x", "y"}, {{"x", 10, 1}, {"y", 11, 1}}),
                                   write("b.mcap", {"z", "y", "x"}, {{"z", 20, 1}, {"y", 21, 2}, {"x", 22, 2}})}));
  EXPECT_EQ(read(reader), (Texts{"x1", "y1", "z1", "y2", "x2"}));
  std::map<std::string, std::uint64_t> counts;
  for (const auto& [id, channel] : reader.channels()) {
    counts[channel.topic] += reader.statistics().channel_message_counts.at(id);
  }
  EXPECT_EQ(reader.channels().size(), 3U);
  EXPECT_EQ(reader.schemas().size(), 3U);
  EXPECT_EQ(counts, (std::map<std::string, std::uint64_t>{{"x", 2}, {"y", 2}, {"z", 1}}));
  EXPECT_EQ(reader.statistics().message_count, 5U);
  EXPECT_EQ(reader.statistics().start_time_ns, 10U);
  EXPECT_EQ(reader.statistics().end_time_ns, 22U);
}

TEST_F(JoinedReaderTest, FiltersByTopicChannelAndTimeAcrossFiles) {
  const JoinedReader reader(
      files({write("a.mcap", {"x", "y"}, {{"x", 10, 1}, {"y", 11, 1}}), write("b.mcap", {"z"}, {{"z", 20, 1}}),
             write("c.mcap", {"y", "x"}, {{"y", 30, 2}, {"x", 31, 2}})}));
  EXPECT_EQ(read(reader, {.topics = {"x"}}), (Texts{"x1", "x2"}));
  ChannelId y{};
  for (const auto& [id, channel] : reader.channels()) y = channel.topic == "y" ? id : y;
  EXPECT_EQ(read(reader, {.channels = {y}}), (Texts{"y1", "y2"})) << "b.mcap does not have the channel";
  EXPECT_EQ(read(reader, {.start_time_ns = 11, .end_time_ns = 30}), (Texts{"y1", "z1", "y2"}));
}

TEST_F(JoinedReaderTest, LogTimesInterleaveAndFilesFollowEachOtherInFileOrder) {
  const auto a = write("a.mcap", {"x"}, {{"x", 10, 1}, {"x", 30, 2}, {"x", 50, 3}});
  const auto b = write("b.mcap", {"y"}, {{"y", 20, 1}, {"y", 30, 2}, {"y", 40, 3}});
  const JoinedReader reader(files({a, b}));
  EXPECT_EQ(read(reader), (Texts{"x1", "y1", "x2", "y2", "y3", "x3"})) << "at equal times in the order of the files";
  EXPECT_EQ(read(reader, {.order = Order::kFile}), (Texts{"x1", "x2", "x3", "y1", "y2", "y3"}));
}

TEST_F(JoinedReaderTest, WhatAFileRepeatsIsThereOnce) {
  const auto a = write("a.mcap", {"e", "x"}, {{"e", 10, 1}, {"x", 11, 1}, {"e", 12, 2}});
  const auto b =
      write("b.mcap", {"e", "x"}, {{"e", 20, 1, 10}, {"e", 20, 2, 12}, {"e", 20, 3}, {"x", 20, 2}, {"e", 21, 4}}, 2);
  const Texts all{"e1", "x1", "e2", "e3", "x2", "e4"};
  for (const Order order : {Order::kLogTime, Order::kFile}) {
    EXPECT_EQ(read(JoinedReader(files({a, b})), {.order = order}), all);
    EXPECT_EQ(read(JoinedReader(files({a, b})), {.topics = {"e"}, .order = order}), (Texts{"e1", "e2", "e3", "e4"}));
  }
  const JoinedReader joined(files({a, b}));
  EXPECT_EQ(joined.statistics().message_count, all.size());
  EXPECT_EQ(read(joined, {.start_time_ns = 20}), (Texts{"e3", "x2", "e4"}));
  EXPECT_EQ(read(joined, {.start_time_ns = 21}), (Texts{"e4"}));
  EXPECT_EQ(read(JoinedReader(b)).size(), 5U) << "alone it has them";
  EXPECT_EQ(Repeated(Reader(b)).count(), 2U);
  EXPECT_EQ(JoinedReader(files({b, a})).repeated().count(), 2U) << "of the first file they are the beginning";
}

TEST_F(JoinedReaderTest, WhatAFileRepeatsIsThereWhereNoFileBeforeItHasIt) {
  // Between the two: 3 of e, and all of f.
  const auto a = write("a.mcap", {"e", "x"}, {{"e", 10, 1}, {"x", 11, 1}, {"e", 12, 2}});
  const auto c = write("c.mcap", {"e", "f", "x"},
                       {{"e", 30, 1, 10}, {"f", 30, 1, 11}, {"e", 30, 3, 21}, {"x", 30, 5}, {"e", 31, 4}}, 3);
  const Texts all{"e1", "x1", "e2", "f1", "e3", "x5", "e4"};
  for (const Order order : {Order::kLogTime, Order::kFile}) {
    EXPECT_EQ(read(JoinedReader(files({a, c})), {.order = order}), all);
  }
  EXPECT_EQ(JoinedReader(files({a, c})).statistics().message_count, all.size());
  const auto d = write("d.mcap", {"e", "f"}, {{"e", 40, 3, 21}, {"f", 40, 1, 11}, {"e", 40, 4, 31}, {"e", 41, 5}}, 3);
  EXPECT_EQ(read(JoinedReader(files({a, c, d}))), (Texts{"e1", "x1", "e2", "f1", "e3", "x5", "e4", "e5"}))
      << "c.mcap repeats 1 of f and 3 of e itself";
}

TEST_F(JoinedReaderTest, WhatWasPublishedBeforeTheFirstFileIsThereOnceWhenItHasIt) {
  const auto a = write("a.mcap", {"e"}, {{"e", 10, 2, 5}, {"e", 11, 3}});
  const auto b = write("b.mcap", {"e"}, {{"e", 20, 1, 4}, {"e", 20, 2, 5}, {"e", 20, 3, 11}, {"e", 21, 4}}, 3);
  EXPECT_EQ(read(JoinedReader(files({a, b}))), (Texts{"e2", "e3", "e1", "e4"}));
}

TEST_F(JoinedReaderTest, ChannelsOfLargeNumbersLeaveRoomForOthers) {
  // Where a file gives an id two meanings, the other one has the largest number.
  const auto a = folder_.file("a.mcap");
  FileBuilder built;
  for (const char* topic : {"x", "y"}) {
    appendChannel(built.bytes, {.id = ChannelId{1}, .topic = topic, .message_encoding = "cdr"});
    appendMessage(built.bytes, {.channel_id = ChannelId{1}, .log_time_ns = 10});
  }
  built.finish();
  saveFile(a, built.bytes);
  const auto b = folder_.file("b.mcap");
  Writer writer(b);
  writer.write(writer.addChannel("z", "cdr", kNoSchema), 1, 20, 20, {});
  writer.close();
  const JoinedReader reader(files({a, b}), [](const auto&, const Damage&) {});
  std::set<std::string> topics;
  for (const auto& [id, channel] : reader.channels()) topics.insert(channel.topic);
  EXPECT_EQ(topics, (std::set<std::string>{"x", "y", "z"}));
}

TEST_F(JoinedReaderTest, SummariesThatLeaveSomethingOutAreNoDamageInSeveralFilesEither) {
  const auto a = write("a.mcap", {"x"}, {{"x", 10, 1}});
  const auto b = folder_.file("b.mcap");
  FileBuilder built;
  const Channel channel{.id = ChannelId{1}, .topic = "x", .message_encoding = "cdr"};
  appendChannel(built.bytes, channel);
  appendMessage(built.bytes, {.channel_id = channel.id, .log_time_ns = 20});
  appendDataEnd(built.bytes, {});
  const std::uint64_t summary_start = built.bytes.size();
  appendChannel(built.bytes, channel);  // and no statistics
  appendFooter(built.bytes, {.summary_start = summary_start});
  append(built.bytes, kMagic);
  Bytes bytes = built.bytes;
  saveFile(b, bytes);
  ASSERT_TRUE(Reader(b).info().is_unindexed) << Reader(b).info().problem;
  EXPECT_TRUE(JoinedReader(files({a, b})).info().is_unindexed);
  EXPECT_FALSE(JoinedReader(files({a, a})).info().is_unindexed) << "nothing is left out";
  const std::uint64_t second = JoinedReader(a).info().file_bytes;
  EXPECT_EQ(JoinedReader(files({a, b})).info().beginnings, (std::vector<std::uint64_t>{0, second}));
  bytes.resize(bytes.size() - 20);
  saveFile(b, bytes);
  EXPECT_FALSE(JoinedReader(files({a, b})).info().is_unindexed) << "it was cut";
}

TEST_F(JoinedReaderTest, AttachmentsAndMetadataAreThoseOfAll) {
  const JoinedReader reader(files({write("a.mcap", {}, {}), write("b.mcap", {"x"}, {{"x", 1, 1}})}));
  std::set<std::string> names;
  for (const AttachmentIndex& index : reader.attachments()) {
    const Bytes data = reader.readAttachment(index);
    names.emplace(reinterpret_cast<const char*>(data.data()), data.size());
  }
  EXPECT_EQ(names, (std::set<std::string>{"a.mcap", "b.mcap"}));
  ASSERT_EQ(reader.metadata().size(), 2U);
  EXPECT_EQ(reader.metadata()[1].values.at("file"), "b.mcap");
  EXPECT_EQ(reader.statistics().start_time_ns, 1U) << "a file without messages has no times";
}

TEST_F(JoinedReaderTest, ACutFileIsNamedAndDamageToldOnceWithItsFile) {
  const auto a = write("a.mcap", {"x"}, {{"x", 10, 1}});
  const auto b = write("b.mcap", {"x"}, {{"x", 20, 2}});
  Bytes bytes = loadFile(b);
  bytes.resize(bytes.size() - 20);
  saveFile(b, bytes);
  EXPECT_FALSE(JoinedReader(files({a, b})).info().is_complete);
  EXPECT_NE(JoinedReader(files({a, b})).info().problem.find("b.mcap: "), std::string::npos);

  Bytes damaged = loadFile(a);
  const ByteView name = asBytes("zstd");
  const auto chunk = std::search(damaged.begin(), damaged.end(), name.begin(), name.end());
  ASSERT_NE(chunk, damaged.end());
  chunk[20] ^= std::byte{0xFF};
  saveFile(a, damaged);
  std::vector<std::filesystem::path> told;
  const JoinedReader reader(files({a, b}), [&](const auto& file, const Damage&) { told.push_back(file); });
  EXPECT_EQ(read(reader), (Texts{"x2"}));
  EXPECT_EQ(read(reader), (Texts{"x2"}));
  EXPECT_EQ(told, (std::vector<std::filesystem::path>{a}));
}

TEST_F(JoinedReaderTest, ListsAreNamedForPeople) {
  EXPECT_EQ(FileList("a.mcap").string(), "a.mcap");
  EXPECT_EQ(files({"a.mcap", "b.mcap"}).string(), "a.mcap and 1 more file");
  EXPECT_EQ(files({"a.mcap", "b.mcap", "c.mcap"}).string(), "a.mcap and 2 more files");
}

}  // namespace
}  // namespace baton::mcap
