#include "mcap/writer.hpp"

#include <algorithm>
#include <map>

#include "recording.hpp"
#include "support/file_size_limit.hpp"

namespace baton::mcap {
namespace {

class WriterTest : public testing::TestWithParam<Compression> {
 protected:
  [[nodiscard]] WriterOptions options(std::size_t chunk_bytes = 4096) const {
    WriterOptions options;
    options.library = "baton test";
    options.compression = GetParam();
    options.chunk_bytes = chunk_bytes;
    options.sync_on_close = false;
    return options;
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
};

INSTANTIATE_TEST_SUITE_P(Compressions, WriterTest,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd),
                         [](const auto& tested) {
                           return tested.param == Compression::kNone ? std::string("none")
                                                                     : std::string(compressionName(tested.param));
                         });

TEST_P(WriterTest, GivesBackWhatWasWritten) {
  std::vector<Sample> written;
  Writer writer(path, options());
  const SchemaId schema = writer.addSchema("baton::msg::PlantState", "omgidl", asBytes("struct PlantState {};"));
  const ChannelId state = writer.addChannel("state", "cdr", schema, {{"writer", "01.0f"}, {"qos", "reliable"}});
  const ChannelId command = writer.addChannel("command", "cdr", kNoSchema);
  for (unsigned i = 0; i < 1000; ++i) {
    const bool is_state = i % 3 != 0;
    written.push_back({.topic = is_state ? "state" : "command",
                       .sequence = i,
                       .log_time_ns = 1'000'000ULL * i,
                       .publish_time_ns = 1'000'000ULL * i + 7,
                       .data = payload(i % 200, i)});
    const Sample& sample = written.back();
    writer.write(is_state ? state : command, sample.sequence, sample.log_time_ns, sample.publish_time_ns, sample.data);
  }
  writer.close();

  const Reader reader(path);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_TRUE(reader.info().has_summary);
  EXPECT_EQ(reader.info().problem, "");
  EXPECT_EQ(reader.info().header.profile, "");
  EXPECT_EQ(reader.info().header.library, "baton test");
  EXPECT_EQ(samplesOf(reader), written);
  EXPECT_EQ(samplesOf(reader, {.order = MessageFilter::Order::kFile}), written);
  ASSERT_EQ(reader.channels().size(), 2U);
  EXPECT_EQ(reader.channels().at(state).metadata.at("qos"), "reliable");
  ASSERT_EQ(reader.schemas().size(), 1U);
  EXPECT_EQ(reader.schemas().at(schema).name, "baton::msg::PlantState");
  EXPECT_GT(reader.statistics().chunk_count, 3U);
  EXPECT_EQ(reader.statistics().message_count, 1000U);
  EXPECT_EQ(reader.statistics().channel_message_counts.at(command), 334U);
  EXPECT_EQ(reader.statistics().start_time_ns, 0U);
  EXPECT_EQ(reader.statistics().end_time_ns, 999'000'000U);
  EXPECT_EQ(reader.dataCrcMatches(), true);
}

TEST_P(WriterTest, AChannelThatComesWhenAChunkIsFullIsInTheData) {
  std::vector<Sample> written;
  Writer writer(path, options(1000));
  for (unsigned i = 0; i < 40; ++i) {
    const std::string topic = "topic" + std::to_string(i);
    const SchemaId schema = writer.addSchema("T" + std::to_string(i), "omgidl", payload(i * 7 % 300, i));
    const ChannelId channel = writer.addChannel(topic, "cdr", schema, {{"of", topic}});
    written.push_back({.topic = topic, .sequence = 1, .log_time_ns = i, .data = payload(50 + i % 200, i)});
    writer.write(channel, 1, i, 0, written.back().data);
  }
  writer.close();
  // Without its summary it has to be explained by its data alone.
  const Bytes whole = loadFile(path);
  saveFile(path, ByteView(whole).first(whole.size() - 10));
  const Reader reader(path);
  EXPECT_FALSE(reader.info().has_summary);
  EXPECT_EQ(reader.channels().size(), 40U);
  EXPECT_EQ(reader.schemas().size(), 40U);
  EXPECT_EQ(samplesOf(reader), written);
}

TEST_P(WriterTest, SummaryAgreesWithWhatIsInTheData) {
  {
    Writer writer(path, options());
    const SchemaId schema = writer.addSchema("T", "omgidl", asBytes("struct T {};"));
    for (unsigned i = 0; i < 50; ++i) {
      const ChannelId channel = writer.addChannel("topic" + std::to_string(i), "cdr", schema);
      for (unsigned k = 0; k < i; ++k) writer.write(channel, k, 100 * i + k, 0, payload(40, k));
      writer.addMetadata("m" + std::to_string(i), {{"i", std::to_string(i)}});
    }
    writer.addAttachment("scenario.yaml", "text/yaml", 5, 6, asBytes("robot: rpp"));
  }
  const InputFile file(path);
  const ReaderOptions reader_options;
  SummaryProblem problem;
  const std::optional<FileIndex> summary = readSummary(file, reader_options, problem);
  ASSERT_TRUE(summary) << problem.text;
  const FileIndex scan = scanFile(file, reader_options, 0, nullptr);
  EXPECT_TRUE(scan.info.is_complete);
  EXPECT_EQ(summary->schemas, scan.schemas);
  EXPECT_EQ(summary->channels, scan.channels);
  EXPECT_EQ(summary->statistics.message_count, scan.statistics.message_count);
  EXPECT_EQ(summary->statistics.channel_message_counts, scan.statistics.channel_message_counts);
  EXPECT_EQ(summary->statistics.start_time_ns, scan.statistics.start_time_ns);
  EXPECT_EQ(summary->statistics.end_time_ns, scan.statistics.end_time_ns);
  ASSERT_EQ(summary->extents.size(), scan.extents.size());
  for (std::size_t i = 0; i < scan.extents.size(); ++i) {
    EXPECT_EQ(summary->extents[i].offset, scan.extents[i].offset);
    EXPECT_EQ(summary->extents[i].length, scan.extents[i].length);
    EXPECT_EQ(summary->extents[i].start_time_ns, scan.extents[i].start_time_ns);
    EXPECT_EQ(summary->extents[i].end_time_ns, scan.extents[i].end_time_ns);
    EXPECT_TRUE(std::ranges::is_permutation(summary->extents[i].channels, scan.extents[i].channels));
  }
  ASSERT_EQ(summary->metadata.size(), scan.metadata.size());
  for (std::size_t i = 0; i < scan.metadata.size(); ++i) {
    EXPECT_EQ(summary->metadata[i].offset, scan.metadata[i].offset);
    EXPECT_EQ(summary->metadata[i].name, scan.metadata[i].name);
  }
  ASSERT_EQ(summary->attachments.size(), 1U);
  EXPECT_EQ(summary->attachments[0].offset, scan.attachments[0].offset);
  EXPECT_EQ(summary->attachments[0].length, scan.attachments[0].length);
}

TEST_P(WriterTest, HoldsMessagesLargerThanAChunk) {
  const Bytes large = payload(3 << 20, 1);
  Writer writer(path, options());
  const ChannelId channel = writer.addChannel("image", "cdr", kNoSchema);
  writer.write(channel, 0, 1, 1, {});
  writer.write(channel, 1, 2, 2, large);
  writer.write(channel, 2, 3, 3, payload(10, 2));
  writer.close();
  const Reader reader(path);
  const std::vector<Sample> samples = samplesOf(reader);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[1].data, large);
  EXPECT_EQ(reader.statistics().chunk_count, 3U);
}

TEST_P(WriterTest, MessageIndexPointsAtEveryMessage) {
  {
    Writer writer(path, options(1 << 20));
    const ChannelId a = writer.addChannel("a", "cdr", kNoSchema);
    const ChannelId b = writer.addChannel("b", "cdr", kNoSchema);
    for (unsigned i = 0; i < 20; ++i) writer.write(i % 4 == 0 ? b : a, i, 10 * i, 0, payload(i, i));
  }
  const Bytes file = loadFile(path);
  const std::vector<RawRecord> records = rawRecords(file);
  const auto chunk_at = std::ranges::find(records, 0x06, &RawRecord::opcode);
  ASSERT_NE(chunk_at, records.end());
  const Chunk chunk = decodeChunk(chunk_at->body);
  Decompressor decompressor;
  Buffer storage;
  const ByteView plain = decompressor.decompress(GetParam(), chunk.records, chunk.plain_size, storage);
  EXPECT_EQ(crcByBits(plain), chunk.plain_crc);
  std::map<ChannelId, std::size_t> counts;
  for (auto record = chunk_at + 1; record->opcode == 0x07; ++record) {
    const MessageIndex index = decodeMessageIndex(record->body);
    counts[index.channel_id] = index.entries.size();
    for (const MessageIndex::Entry& entry : index.entries) {
      ByteReader in(plain.subspan(entry.offset));
      const std::optional<RecordView> found = nextRecord(in);
      ASSERT_EQ(found->opcode, Opcode::kMessage);
      EXPECT_EQ(decodeMessage(found->body).channel_id, index.channel_id);
      EXPECT_EQ(decodeMessage(found->body).log_time_ns, entry.log_time_ns);
    }
  }
  EXPECT_EQ(counts, (std::map<ChannelId, std::size_t>{{ChannelId{1}, 15}, {ChannelId{2}, 5}}));
}

TEST_P(WriterTest, WritesTheSameBytesForTheSameCalls) {
  for (const char* name : {"one.mcap", "two.mcap"}) {
    Writer writer(folder.file(name), options());
    const ChannelId channel = writer.addChannel("a", "cdr", kNoSchema);
    for (unsigned i = 0; i < 500; ++i) writer.write(channel, i, i, i, payload(50, i));
  }
  EXPECT_EQ(loadFile(folder.file("one.mcap")), loadFile(folder.file("two.mcap")));
}

class PlainWriterTest : public WriterTest {};
INSTANTIATE_TEST_SUITE_P(None, PlainWriterTest, testing::Values(Compression::kNone));

TEST_P(PlainWriterTest, LaysRecordsOutAsSpecified) {
  {
    Writer writer(path, options());
    const ChannelId a = writer.addChannel("a", "cdr", writer.addSchema("T", "omgidl", asBytes("struct T {};")));
    writer.write(a, 1, 10, 9, payload(8, 1));
    writer.addMetadata("early", {{"k", "v"}});  // in the middle of a chunk
    writer.write(a, 2, 20, 19, payload(8, 2));
    writer.addAttachment("file", "text/plain", 30, 0, asBytes("hello"));
    writer.write(a, 3, 40, 39, payload(8, 3));
  }
  const Bytes file = loadFile(path);
  EXPECT_TRUE(std::ranges::equal(ByteView(file).first(8), kMagic));
  EXPECT_TRUE(std::ranges::equal(ByteView(file).last(8), kMagic));
  const std::vector<RawRecord> records = rawRecords(file);
  EXPECT_EQ(opcodesOf(records), (std::vector<int>{0x01,                    // header
                                                  0x06, 0x07, 0x0C, 0x09,  // chunk, metadata, attachment
                                                  0x06, 0x07, 0x0F,        // chunk, end of data
                                                  0x03, 0x04, 0x0B, 0x08, 0x08, 0x0A, 0x0D,  // summary
                                                  0x0E, 0x0E, 0x0E, 0x0E, 0x0E, 0x0E, 0x02}));
  const auto first = [&](int opcode) { return *std::ranges::find(records, opcode, &RawRecord::opcode); };

  // The first chunk: its CRC, and inside it schema and channel before the messages.
  const ByteView chunk = first(0x06).body;
  EXPECT_EQ(numberAt<std::uint64_t>(chunk, 0), 10U);
  EXPECT_EQ(numberAt<std::uint64_t>(chunk, 8), 20U);
  const ByteView chunk_records = chunk.subspan(8 + 8 + 8 + 4 + 4 + 8);
  EXPECT_EQ(numberAt<std::uint64_t>(chunk, 16), chunk_records.size());
  EXPECT_EQ(numberAt<std::uint32_t>(chunk, 24), crcByBits(chunk_records));
  Bytes framed(8);  // rawRecords expects a magic on both sides
  append(framed, chunk_records);
  framed.resize(framed.size() + 8);
  EXPECT_EQ(opcodesOf(rawRecords(framed)), (std::vector<int>{0x03, 0x04, 0x05, 0x05}));

  // The CRCs of attachment, data section and summary.
  const ByteView attachment = first(0x09).body;
  EXPECT_EQ(numberAt<std::uint32_t>(attachment, attachment.size() - 4),
            crcByBits(attachment.first(attachment.size() - 4)));
  const RawRecord data_end = first(0x0F);
  EXPECT_EQ(numberAt<std::uint32_t>(data_end.body, 0), crcByBits(ByteView(file).first(data_end.offset)));
  const ByteView footer = records.back().body;
  const auto summary_start = numberAt<std::uint64_t>(footer, 0);
  EXPECT_EQ(summary_start, data_end.end());
  EXPECT_EQ(numberAt<std::uint64_t>(footer, 8), first(0x0E).offset);
  EXPECT_EQ(numberAt<std::uint32_t>(footer, 16),
            crcByBits(ByteView(file).subspan(summary_start, file.size() - 8 - 4 - summary_start)));

  // Every summary offset names a group: where it begins, and that it ends where the next group begins.
  std::uint64_t group_begin = summary_start;
  for (const RawRecord& record : records) {
    if (record.opcode != 0x0E) continue;
    const SummaryOffset group = decodeSummaryOffset(record.body);
    EXPECT_EQ(group.group_start, group_begin);
    EXPECT_EQ(file[group.group_start], static_cast<std::byte>(group.group));
    group_begin += group.group_length;
  }
  EXPECT_EQ(group_begin, first(0x0E).offset);
}

TEST_P(PlainWriterTest, FinishesAnEmptyFile) {
  Writer(path, options()).close();
  const Reader reader(path);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_EQ(reader.statistics().message_count, 0U);
  EXPECT_TRUE(samplesOf(reader).empty());
  EXPECT_EQ(opcodesOf(rawRecords(loadFile(path))), (std::vector<int>{0x01, 0x0F, 0x0B, 0x0E, 0x02}));
}

TEST_P(PlainWriterTest, ChannelsWithoutMessagesNeedNoChunk) {
  {
    Writer writer(path, options());
    writer.addChannel("silent", "cdr", writer.addSchema("T", "omgidl", asBytes("struct T {};")));
  }
  const Reader reader(path);
  EXPECT_TRUE(reader.info().has_summary) << reader.info().problem;
  EXPECT_EQ(reader.channels().at(ChannelId{1}).topic, "silent");
  EXPECT_EQ(reader.statistics().chunk_count, 0U);
}

TEST_P(PlainWriterTest, WithoutCrcLeavesThemZero) {
  {
    WriterOptions without = options();
    without.has_crc = false;
    Writer writer(path, without);
    writer.write(writer.addChannel("a", "cdr", kNoSchema), 0, 0, 0, payload(8, 1));
    writer.addAttachment("file", "text/plain", 0, 0, asBytes("hello"));
  }
  const Bytes file = loadFile(path);
  for (const RawRecord& record : rawRecords(file)) {
    if (record.opcode == 0x06) {
      EXPECT_EQ(decodeChunk(record.body).plain_crc, 0U);
    }
    if (record.opcode == 0x09) {
      EXPECT_EQ(numberAt<std::uint32_t>(record.body, record.body.size() - 4), 0U);
    }
    if (record.opcode == 0x0F) {
      EXPECT_EQ(decodeDataEnd(record.body).data_crc, 0U);
    }
    if (record.opcode == 0x02) {
      EXPECT_EQ(decodeFooter(record.body).summary_crc, 0U);
    }
  }
  EXPECT_EQ(Reader(path).statistics().message_count, 1U);
}

TEST_P(PlainWriterTest, KeepsMetadataAndAttachments) {
  const Bytes blob = payload(100'000, 3);
  {
    Writer writer(path, options());
    writer.addMetadata("manifest", {{"scenario", "wall"}, {"seed", "7"}, {"", ""}});
    writer.addAttachment("blob", "application/octet-stream", 11, 12, blob);
    writer.addAttachment("empty", "", 0, 0, {});
    writer.addMetadata("end", {});
  }
  const Reader reader(path);
  const std::vector<Metadata> metadata = reader.metadata();
  ASSERT_EQ(metadata.size(), 2U);
  EXPECT_EQ(metadata[0].name, "manifest");
  EXPECT_EQ(metadata[0].values, (StringMap{{"scenario", "wall"}, {"seed", "7"}, {"", ""}}));
  EXPECT_EQ(metadata[1].name, "end");
  ASSERT_EQ(reader.attachments().size(), 2U);
  EXPECT_EQ(reader.attachments()[0].media_type, "application/octet-stream");
  EXPECT_EQ(reader.attachments()[0].log_time_ns, 11U);
  EXPECT_EQ(reader.attachments()[0].create_time_ns, 12U);
  EXPECT_EQ(reader.readAttachment(reader.attachments()[0]), blob);
  EXPECT_TRUE(reader.readAttachment(reader.attachments()[1]).empty());
}

TEST_P(PlainWriterTest, FlushMakesEverythingReadableByOthers) {
  Writer writer(path, options(1 << 20));
  const ChannelId channel = writer.addChannel("a", "cdr", kNoSchema);
  writer.write(channel, 0, 1, 1, payload(8, 1));
  writer.addMetadata("m", {});
  EXPECT_EQ(writer.statistics().messages, 1U);
  EXPECT_EQ(writer.statistics().written_messages, 0U);
  writer.flush();
  EXPECT_EQ(writer.statistics().written_messages, 1U);
  EXPECT_EQ(writer.statistics().chunks, 1U);
  EXPECT_EQ(writer.statistics().file_bytes, std::filesystem::file_size(path));
  const Reader reader(path);
  EXPECT_FALSE(reader.info().is_complete);
  EXPECT_EQ(logTimesOf(reader), std::vector<std::uint64_t>{1});
  EXPECT_EQ(reader.metadata().size(), 1U);
}

// Wherever a disk ends: within a chunk, between it and its index, within the index, within the summary.
TEST_P(PlainWriterTest, CountsAsWrittenWhatAReaderFindsWhereverTheDiskEnds) {
  const auto write = [&](const std::filesystem::path& file, rlim_t room) {
    Writer writer(file, options(400));
    const test::FileSizeLimit limit(room);
    try {
      const ChannelId channel = writer.addChannel("topic", "cdr", writer.addSchema("Type", "", {}), {});
      for (std::uint32_t i = 0; i < 12; ++i) writer.write(channel, i, i, i, payload(90, i));
      writer.close();
    } catch (const WriteError&) {
    }
    return writer.statistics().written_messages;
  };
  const std::filesystem::path all = folder.file("all");
  ASSERT_EQ(write(all, RLIM_INFINITY), 12U);
  const auto size = std::filesystem::file_size(all);
  for (rlim_t room = 200; room < size; room += 3) {
    SCOPED_TRACE(room);
    const std::filesystem::path cut = folder.file("cut" + std::to_string(room));
    const std::uint64_t written = write(cut, room);
    EXPECT_EQ(Reader(cut).statistics().message_count, written);
    std::filesystem::remove(cut);
  }
}

TEST_P(PlainWriterTest, CountsAsDurableOnlyWhatWasSynced) {
  Writer writer(path, options());
  const ChannelId channel = writer.addChannel("a", "cdr", kNoSchema);
  writer.write(channel, 0, 1, 1, payload(8, 1));
  writer.flush();
  EXPECT_EQ(writer.statistics().durable_bytes, 0U);
  writer.sync();
  EXPECT_EQ(writer.statistics().durable_bytes, writer.statistics().file_bytes);
  writer.write(channel, 1, 2, 2, payload(8, 1));
  writer.flush();
  EXPECT_LT(writer.statistics().durable_bytes, writer.statistics().file_bytes);
}

TEST_P(PlainWriterTest, BringsEveryChunkToTheDeviceWhenToldTo) {
  WriterOptions every_chunk = options();
  every_chunk.sync_chunks = true;
  every_chunk.chunk_bytes = 1000;
  Writer writer(path, every_chunk);
  const ChannelId channel = writer.addChannel("a", "cdr", kNoSchema);
  for (unsigned i = 0; i < 100; ++i) {
    writer.write(channel, i, i, i, payload(100, i));
    const WriterStatistics statistics = writer.statistics();
    if (statistics.chunks > 0) {
      EXPECT_EQ(statistics.durable_bytes, statistics.file_bytes);
    }
  }
  EXPECT_GT(writer.statistics().chunks, 5U);
}

TEST_P(PlainWriterTest, ClosesOnceAndTakesNothingAfterwards) {
  Writer writer(path, options());
  const ChannelId channel = writer.addChannel("a", "cdr", kNoSchema);
  writer.close();
  const Bytes closed = loadFile(path);
  EXPECT_NO_THROW(writer.close());
  EXPECT_THROW(writer.write(channel, 0, 0, 0, {}), WriteError);
  EXPECT_THROW(writer.addMetadata("late", {}), WriteError);
  EXPECT_THROW(writer.flush(), WriteError);
  EXPECT_EQ(loadFile(path), closed);
}

TEST_P(PlainWriterTest, RefusesToOverwriteUnlessTold) {
  saveFile(path, asBytes("precious"));
  try {
    const Writer writer(path, options());
    FAIL() << "overwrote a file";
  } catch (const UnavailableError& error) {
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
  }
  EXPECT_EQ(loadFile(path).size(), 8U);
  WriterOptions replacing = options();
  replacing.if_exists = OutputFile::IfExists::kReplace;
  Writer(path, replacing).close();
  EXPECT_TRUE(Reader(path).info().is_complete);
}

TEST_P(PlainWriterTest, RefusesWhatWasNotAdded) {
  Writer writer(path, options());
  EXPECT_THROW(writer.write(ChannelId{0}, 0, 0, 0, {}), UsageError);
  EXPECT_THROW(writer.write(ChannelId{1}, 0, 0, 0, {}), UsageError);
  EXPECT_THROW(writer.addChannel("a", "cdr", SchemaId{1}), UsageError);
}

TEST_P(PlainWriterTest, RefusesOptionsOutOfRangeBeforeCreatingAFile) {
  WriterOptions wrong = options(0);
  EXPECT_THROW(Writer(path, wrong), UsageError);
  wrong = options();
  wrong.compression = Compression::kZstd;
  wrong.compression_level = 99;
  EXPECT_THROW(Writer(path, wrong), UsageError);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_P(PlainWriterTest, TheSameSchemaKeepsItsId) {
  Writer writer(path, options());
  const SchemaId first = writer.addSchema("T", "omgidl", asBytes("struct T {};"));
  EXPECT_EQ(writer.addSchema("T", "omgidl", asBytes("struct T {};")), first);
  EXPECT_NE(writer.addSchema("T", "omgidl", asBytes("struct T { long a; };")), first);
}

TEST_P(PlainWriterTest, HasIdsForTheWholeRangeAndNoMore) {
  Writer writer(path, options(1 << 20));
  for (unsigned i = 0; i < 65535; ++i) writer.addChannel(std::to_string(i), "cdr", kNoSchema);
  EXPECT_THROW(writer.addChannel("one too many", "cdr", kNoSchema), UsageError);
  writer.write(ChannelId{65535}, 0, 1, 1, {});
  writer.close();
  const Reader reader(path);
  EXPECT_EQ(reader.channels().size(), 65535U);
  EXPECT_EQ(samplesOf(reader, {.topics = {"65534"}}).size(), 1U);
}

}  // namespace
}  // namespace baton::mcap
