#include "mcap/reader.hpp"

#include <algorithm>
#include <numeric>

#include "recording.hpp"

namespace baton::mcap {
namespace {

class ReaderTest : public testing::Test {
 protected:
  /// Messages 0 to n - 1 ns, alternating over three topics, 100 or so to a chunk.
  void writeSteps(unsigned n) {
    WriterOptions options;
    options.chunk_bytes = 4096;
    options.sync_on_close = false;
    Writer writer(path, options);
    for (const char* topic : {"a", "b", "c"}) writer.addChannel(topic, "cdr", kNoSchema);
    for (unsigned i = 0; i < n; ++i) {
      writer.write(ChannelId{static_cast<std::uint16_t>(1 + i % 3)}, i, i, i, payload(8, i));
    }
  }

  static Bytes channelRecord(std::uint16_t id) {
    Bytes bytes;
    appendChannel(bytes, {.id = ChannelId{id}, .topic = "t" + std::to_string(id), .message_encoding = "cdr"});
    return bytes;
  }
  static void appendTimes(Bytes& out, const std::vector<std::uint64_t>& times, std::uint32_t sequence = 0) {
    for (const std::uint64_t time : times) {
      appendMessage(out, {.channel_id = ChannelId{1}, .sequence = sequence++, .log_time_ns = time});
    }
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
};

TEST_F(ReaderTest, SelectsByTopicChannelAndTime) {
  writeSteps(3000);
  const Reader reader(path);
  EXPECT_EQ(samplesOf(reader, {.topics = {"b"}}).size(), 1000U);
  EXPECT_EQ(samplesOf(reader, {.channels = {ChannelId{3}}, .topics = {"b"}}).size(), 2000U);
  EXPECT_TRUE(samplesOf(reader, {.topics = {"unknown"}}).empty());
  EXPECT_TRUE(samplesOf(reader, {.channels = {ChannelId{77}}}).empty());
  const std::vector<std::uint64_t> times = logTimesOf(reader, {.start_time_ns = 1234, .end_time_ns = 1300});
  ASSERT_EQ(times.size(), 67U);
  EXPECT_EQ(times.front(), 1234U);
  EXPECT_EQ(times.back(), 1300U);
  EXPECT_EQ(logTimesOf(reader, {.topics = {"a"}, .start_time_ns = 2998}), std::vector<std::uint64_t>{});
  EXPECT_EQ(logTimesOf(reader, {.start_time_ns = 2999}), std::vector<std::uint64_t>{2999});
}

TEST_F(ReaderTest, ReadsOnlyTheChunksATimeRangeNeeds) {
  writeSteps(3000);
  Bytes file = loadFile(path);
  // Ruin the first chunk's data: a range in the last one must not notice.
  const std::vector<RawRecord> records = rawRecords(file);
  ASSERT_EQ(records[1].opcode, 0x06);
  file[records[1].offset + 100] ^= std::byte{0xFF};
  saveFile(path, file);
  const Reader reader(path);
  EXPECT_EQ(logTimesOf(reader, {.start_time_ns = 2990}).size(), 10U);
  EXPECT_THROW(logTimesOf(reader), FormatError);
}

TEST_F(ReaderTest, ASummaryCanBeTakenByItsWord) {
  writeSteps(3000);
  Bytes file = loadFile(path);
  file[rawRecords(file)[1].offset + 100] ^= std::byte{0xFF};  // in the first chunk's data: which are not looked at
  saveFile(path, file);
  std::vector<Damage> damage;
  ReaderOptions options;
  options.trusts_summary = true;
  options.on_damage = [&](const Damage& found) { damage.push_back(found); };
  bool is_read = false;
  options.on_progress = [&](std::uint64_t, std::uint64_t) { is_read = true; };
  const Reader trusting(path, options);
  EXPECT_EQ(trusting.statistics().message_count, 3000U);
  EXPECT_FALSE(is_read);
  // Without one it is read whole.
  const std::vector<RawRecord> records = rawRecords(file);
  std::filesystem::resize_file(path, std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset);
  const Reader cut(path, options);
  EXPECT_TRUE(is_read);
  EXPECT_LT(cut.statistics().message_count, 3000U);
  EXPECT_EQ(damage.size(), 1U);
}

TEST_F(ReaderTest, ShowsAProgramThatAFileIsBeingOpened) {
  writeSteps(3000);
  std::vector<std::uint64_t> seen;
  setOpeningSink([&](const std::filesystem::path& file, std::uint64_t done, std::uint64_t of) {
    EXPECT_EQ(file, path);
    EXPECT_EQ(of, std::filesystem::file_size(path));
    seen.push_back(done);
  });
  const Reader reader(path);
  EXPECT_GT(seen.size(), 10U);
  EXPECT_TRUE(std::ranges::is_sorted(seen));
  EXPECT_EQ(seen.back(), std::filesystem::file_size(path));
  seen.clear();
  ReaderOptions options;
  options.on_progress = [](std::uint64_t, std::uint64_t) {};
  const Reader other(path, options);
  EXPECT_TRUE(seen.empty()) << "it is shown already";
  saveFile(path, asBytes("no recording"));
  EXPECT_THROW(Reader{path}, FormatError);
  EXPECT_EQ(seen, std::vector<std::uint64_t>{12}) << "the line is free again";
  setOpeningSink({});
}

TEST_F(ReaderTest, OverlappingChunksComeInLogTimeOrder) {
  FileBuilder file;
  Bytes first = channelRecord(1);
  appendTimes(first, {5, 1, 9}, 0);
  file.chunk(first, 1, 9);
  Bytes second;
  appendTimes(second, {2, 5, 20}, 10);
  file.chunk(second, 2, 20);
  Bytes third;
  appendTimes(third, {15, 3}, 20);
  file.chunk(third, 3, 15);
  file.finish();
  saveFile(path, file.bytes);
  const Reader reader(path);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_FALSE(reader.info().has_summary);
  EXPECT_EQ(reader.info().problem, "");  // a file may well have no summary
  EXPECT_EQ(logTimesOf(reader), (std::vector<std::uint64_t>{1, 2, 3, 5, 5, 9, 15, 20}));
  EXPECT_EQ(logTimesOf(reader, {.order = MessageFilter::Order::kFile}),
            (std::vector<std::uint64_t>{5, 1, 9, 2, 5, 20, 15, 3}));
  std::vector<std::uint32_t> sequences;  // equal times: as in the file
  for (const Sample& sample : samplesOf(reader, {.start_time_ns = 5, .end_time_ns = 5})) {
    sequences.push_back(sample.sequence);
  }
  EXPECT_EQ(sequences, (std::vector<std::uint32_t>{0, 11}));
  EXPECT_EQ(reader.statistics().start_time_ns, 1U);
  EXPECT_EQ(reader.statistics().end_time_ns, 20U);
}

TEST_F(ReaderTest, RandomTimesAreSortedWithoutLoss) {
  std::mt19937 generator(4);
  std::vector<std::uint64_t> all;
  FileBuilder file;
  append(file.bytes, channelRecord(1));
  for (int chunk = 0; chunk < 30; ++chunk) {
    std::vector<std::uint64_t> times(20);
    for (std::uint64_t& time : times) time = generator() % 500;
    Bytes records;
    appendTimes(records, times);
    file.chunk(records, *std::ranges::min_element(times), *std::ranges::max_element(times));
    all.insert(all.end(), times.begin(), times.end());
  }
  file.finish();
  saveFile(path, file.bytes);
  const Reader reader(path);
  EXPECT_EQ(logTimesOf(reader, {.order = MessageFilter::Order::kFile}), all);
  std::ranges::sort(all);
  EXPECT_EQ(logTimesOf(reader), all);
}

TEST_F(ReaderTest, FindsMessagesOutsideOfChunks) {
  FileBuilder file;
  append(file.bytes, channelRecord(1));
  appendTimes(file.bytes, {1, 2});
  Bytes records;
  appendTimes(records, {3});
  file.chunk(records, 3, 3);
  appendTimes(file.bytes, {4});
  file.finish();
  saveFile(path, file.bytes);
  const Reader reader(path);
  EXPECT_EQ(logTimesOf(reader), (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_EQ(reader.statistics().chunk_count, 1U);
}

TEST_F(ReaderTest, ReadsAFileWithoutChunksInPieces) {
  FileBuilder file;
  append(file.bytes, channelRecord(1));
  const Bytes data = payload(1 << 20, 1);
  std::vector<std::uint64_t> times(11);
  std::iota(times.begin(), times.end(), 0);
  for (const std::uint64_t time : times) {
    appendMessage(file.bytes, {.channel_id = ChannelId{1}, .log_time_ns = time, .data = data});
  }
  file.finish();
  saveFile(path, file.bytes);
  ReaderOptions options;
  options.max_chunk_bytes = 5 << 20;  // less than the file
  EXPECT_EQ(logTimesOf(Reader(path, options)), times);
}

TEST_F(ReaderTest, DoesNotTrustASummaryThatLeavesMessagesOut) {
  writeSteps(300);
  // A message outside of the chunks, which the summary does not know of: put it in front of DataEnd and move the
  // summary's own places along.
  const Bytes file = loadFile(path);
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord data_end = *std::ranges::find(records, 0x0F, &RawRecord::opcode);
  Bytes changed(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(data_end.offset));
  appendTimes(changed, {5000});
  const std::size_t shift = changed.size() - data_end.offset;
  append(changed, ByteView(file).subspan(data_end.offset, records.back().offset - data_end.offset));
  appendFooter(changed, {.summary_start = data_end.end() + shift});
  append(changed, kMagic);
  saveFile(path, changed);
  const Reader reader(path);
  EXPECT_FALSE(reader.info().has_summary);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_NE(reader.info().problem.find("does not list the Message"), std::string::npos) << reader.info().problem;
  EXPECT_EQ(logTimesOf(reader).size(), 301U);
}

TEST_F(ReaderTest, SkipsRecordsItDoesNotKnow) {
  FileBuilder file;
  file.record(0x7F, asBytes("reserved"));
  Bytes records = channelRecord(1);
  FileBuilder::rawRecord(records, 0x80, asBytes("private"));
  appendTimes(records, {1, 2});
  FileBuilder::rawRecord(records, 0x06, asBytes("a chunk in a chunk is not looked into"));
  appendTimes(records, {3});
  file.chunk(records, 1, 3);
  file.record(0xFF, {});
  file.finish();
  saveFile(path, file.bytes);
  const Reader reader(path);
  EXPECT_TRUE(reader.info().is_complete) << reader.info().problem;
  EXPECT_EQ(logTimesOf(reader), (std::vector<std::uint64_t>{1, 2, 3}));
}

TEST_F(ReaderTest, IgnoresFieldsAddedToRecords) {
  const Bytes channel = channelRecord(1);
  Bytes body(channel.begin() + kRecordHeadBytes, channel.end());
  append(body, asBytes("from a later version"));
  FileBuilder file;
  file.record(0x04, body);
  appendTimes(file.bytes, {7});
  file.finish();
  saveFile(path, file.bytes);
  EXPECT_EQ(samplesOf(Reader(path)).at(0).topic, "t1");
}

TEST_F(ReaderTest, SeveralCursorsWalkOneFile) {
  writeSteps(600);
  const Reader reader(path);
  MessageCursor ahead = reader.messages();
  MessageView message;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(ahead.next(message));
  MessageCursor behind = reader.messages();
  MessageView other;
  ASSERT_TRUE(behind.next(other));
  EXPECT_EQ(message.log_time_ns, 299U);
  EXPECT_EQ(other.log_time_ns, 0U);
  EXPECT_EQ(Bytes(message.data.begin(), message.data.end()), payload(8, 299));
  while (ahead.next(message)) {
  }
  EXPECT_FALSE(ahead.next(message));
}

TEST_F(ReaderTest, RefusesWhatIsNotARecording) {
  EXPECT_THROW(Reader(folder.file("absent")), UnavailableError);
  for (const auto& [text, hint] :
       {std::pair{"", "it is empty"},
        {"hello", "the MCAP magic"},
        {"#ROSBAG V2.0\n and more of it", "a ROS 1 bag: `mcap convert`"},
        {"SQLite format 3", "rosbag2 records in (.db3): `ros2 bag convert`"},
        {"<?xml version=\"1.0\"?><robot/>", "a robot description (URDF)"},
        {"\n <robot name=\"a\"/>", "a robot description (URDF)"},
        {"   ", "the MCAP magic"},
        {"name: mine\nrobot: \xc3\xa9\n", "it is text"},
        {"\x01\x02 binary", "it does not begin with the MCAP magic, and nothing in it does; give"},
        {"\x28\xb5\x2f\xfd and so on", "`zstd -d`"},
        {"\x1f\x8b\x08", "`gunzip`"},
        {"BZh91AY", "`bunzip2`"},
        {"\xfd\x37zXZ", "`unxz`"},
        {"\x04\x22\x4d\x18", "`lz4 -d`"},
        {"PK\x03\x04", "`unzip`"},
        {"\x1f\x8b\x08", "decompress it"}}) {
    saveFile(path, asBytes(text));
    try {
      const Reader reader(path);
      ADD_FAILURE() << "took \"" << text << "\" for a recording";
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find("is not an MCAP recording: "), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(hint), std::string::npos) << error.what();
    }
  }
  saveFile(path, Bytes(5000));
  try {
    const Reader reader(path);
    ADD_FAILURE() << "took zeros for a recording";
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("it begins with 64 zero bytes"), std::string::npos) << error.what();
  }
  try {
    const Reader reader(path.parent_path());
    ADD_FAILURE() << "took a folder for a recording";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("is a folder"), std::string::npos) << error.what();
  }
}

TEST_F(ReaderTest, RefusesMessagesOfUnknownChannels) {
  FileBuilder file;
  appendTimes(file.bytes, {1});
  file.finish();
  saveFile(path, file.bytes);
  EXPECT_THROW(Reader{path}, FormatError);
}

}  // namespace
}  // namespace baton::mcap
