/// What a damaged chunk, or a message that belongs nowhere, costs: itself, and nothing after it.
#include <algorithm>

#include "indexed_file.hpp"
#include "mcap/copy.hpp"

namespace baton::mcap {
namespace {

Channel channelOf(std::uint16_t id, const std::string& topic) {
  return {.id = ChannelId{id}, .schema_id = kNoSchema, .topic = topic, .message_encoding = "cdr"};
}

class SalvageTest : public testing::Test {
 protected:
  ReaderOptions tolerant() {
    ReaderOptions options;
    options.on_damage = [this](const Damage& one) { damage.push_back(one); };
    return options;
  }
  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
  std::vector<Damage> damage;
};

TEST_F(SalvageTest, NoChunkOfOursNeedsAnother) {
  {
    WriterOptions options;
    options.chunk_bytes = 400;
    Writer writer(path, options);
    const SchemaId schema = writer.addSchema("T", "omgidl", asBytes("struct T {};"));
    const ChannelId a = writer.addChannel("a", "cdr", schema), b = writer.addChannel("b", "cdr", schema);
    for (unsigned i = 0; i < 60; ++i) writer.write(i % 2 == 0 ? a : b, i, i, i, payload(30, i));
    writer.close();
  }
  const Bytes file = loadFile(path);
  const std::vector<RawRecord> records = rawRecords(file);
  const std::size_t data_end = std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset;
  const std::vector<Sample> all = samplesOf(Reader(path));
  int chunks = 0;
  for (const RawRecord& record : records) {
    if (record.opcode != 0x06) continue;
    ++chunks;
    const Chunk chunk = decodeChunk(record.body);
    Bytes damaged(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(data_end));
    damaged[record.end() - 3] ^= std::byte{0xFF};
    saveFile(path, damaged);
    std::vector<Sample> expected = all;
    std::erase_if(expected, [&](const Sample& one) {
      return one.log_time_ns >= chunk.start_time_ns && one.log_time_ns <= chunk.end_time_ns;
    });
    const Reader reader(path, tolerant());
    EXPECT_EQ(samplesOf(reader), expected);
    EXPECT_EQ(reader.channels().size(), 2U);
    EXPECT_EQ(reader.schemas().size(), 1U);
  }
  EXPECT_GT(chunks, 5);
}

TEST_F(SalvageTest, ASchemaLargerThanAChunkLeavesRoomForMessages) {
  {
    WriterOptions options;
    options.chunk_bytes = 1000;
    Writer writer(path, options);
    const ChannelId a = writer.addChannel("a", "cdr", writer.addSchema("T", "omgidl", payload(5000, 1)));
    for (unsigned i = 0; i < 100; ++i) writer.write(a, i, i, i, payload(69, i));
    writer.close();
  }
  EXPECT_EQ(Reader(path).statistics().chunk_count, 11U) << "ten messages to a chunk, and one with the first schema";
}

TEST_F(SalvageTest, AMessageOfAnUndeclaredChannelCostsItselfAlone) {
  IndexedFile file;
  file.message(9, 1);  // declared nowhere
  file.channel(channelOf(1, "a"));
  file.message(1, 2);
  file.message(2, 3);  // declared after it, in the same chunk
  file.channel(channelOf(2, "b"));
  file.message(9, 4);
  file.closeChunk();
  file.message(1, 5);
  file.message(3, 6);  // declared in a later chunk only
  file.closeChunk();
  file.channel(channelOf(3, "c"));
  file.message(3, 7);
  file.closeChunk();
  file.change_summary = [](IndexedFile& f) { f.statistics.channel_message_counts.erase(ChannelId{9}); };
  for (const bool is_cut : {true, false}) {
    damage.clear();
    saveFile(path, is_cut ? file.cut() : file.finished());
    // A summary declares what is declared in any chunk.
    const std::vector<std::uint64_t> by_chunks{2, 3, 5, 7}, by_summary{2, 3, 5, 6, 7};
    EXPECT_EQ(logTimesOf(Reader(path, tolerant())), is_cut ? by_chunks : by_summary);
    ASSERT_EQ(damage.size(), is_cut ? 2U : 1U);
    EXPECT_EQ(damage[0].messages, 2U) << describe(damage[0]);
    EXPECT_NE(describe(damage[0]).find("2 messages in the chunk at byte"), std::string::npos) << describe(damage[0]);
    EXPECT_EQ(damage.back().messages, is_cut ? 1U : 2U);
    for (const Damage& one : damage) EXPECT_EQ(one.length, 0U) << "its bytes could be read";
    EXPECT_THROW(Reader{path}, FormatError);
    RecoverOptions options;
    options.writer.if_exists = OutputFile::IfExists::kReplace;
    const Recovery found = recover(path, folder.file("out.mcap"), options);
    EXPECT_EQ(found.messages, is_cut ? 4U : 5U);
    EXPECT_EQ(found.lost.size(), is_cut ? 3U : 1U);
    EXPECT_TRUE(found.info.contradictions.empty()) << found.info.contradictions.front();
  }
}

TEST_F(SalvageTest, RecordsThatHaveNoPlaceInAChunkAreNamedAndCounted) {
  FileBuilder file;
  Bytes records;
  appendChannel(records, channelOf(1, "a"));
  FileBuilder::rawRecord(records, 0x06, asBytes("a chunk"));
  FileBuilder::rawRecord(records, 0x09, asBytes("an attachment"));
  FileBuilder::rawRecord(records, 0x80, asBytes("private"));
  FileBuilder::rawRecord(records, 0x09, asBytes("another one"));
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1});
  const std::string at = std::to_string(file.bytes.size());
  file.chunk(records, 1, 1);
  file.finish();
  saveFile(path, file.bytes);
  const Reader reader(path, tolerant());
  EXPECT_EQ(samplesOf(reader).size(), 1U);
  EXPECT_EQ(reader.info().unknown_records, 1U);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_EQ(describe(damage[0]), "something is missing at byte " + at + ": the chunk at byte " + at +
                                     " holds what has no place in one and is left out: 1 Chunk, 2 Attachment");
  EXPECT_EQ(Reader(path).info().contradictions.size(), 1U) << "also for who reads sound recordings only";
  const Recovery found = recover(path, folder.file("out.mcap"), {});
  EXPECT_EQ(found.messages, 1U);
  EXPECT_EQ(found.lost.size(), 1U);
}

TEST_F(SalvageTest, ABadRecordCostsItselfAndNotItsChunk) {
  for (const std::uint8_t opcode : {std::uint8_t{0x03}, std::uint8_t{0x04}, std::uint8_t{0x05}}) {
    IndexedFile file;
    file.channel(channelOf(1, "a"));
    file.message(1, 1);
    FileBuilder::rawRecord(file.records, opcode, payload(5, 7));  // too short for any of them
    file.message(1, 2);
    file.closeChunk();
    file.message(1, 3);
    file.closeChunk();
    for (const bool is_cut : {true, false}) {
      SCOPED_TRACE(std::to_string(opcode) + (is_cut ? ", cut" : ""));
      damage.clear();
      saveFile(path, is_cut ? file.cut() : file.finished());
      EXPECT_EQ(logTimesOf(Reader(path, tolerant())), (std::vector<std::uint64_t>{1, 2, 3}));
      ASSERT_EQ(damage.size(), 1U);
      EXPECT_EQ(damage[0].messages, opcode == 0x05 ? 1U : 0U);
      EXPECT_NE(describe(damage[0]).find("in the chunk at byte " + std::to_string(file.chunks[0].chunk_offset)),
                std::string::npos)
          << describe(damage[0]);
      EXPECT_NE(describe(damage[0]).find("of 14 bytes from byte"), std::string::npos) << describe(damage[0]);
      if (is_cut || opcode == 0x05) {  // otherwise no message is missing, and the summary has the declarations
        EXPECT_THROW((void)logTimesOf(Reader(path)), FormatError);
      }
    }
  }
}

TEST_F(SalvageTest, ABadLengthInAChunkCostsWhatFollowsIt) {
  IndexedFile file;
  file.channel(channelOf(1, "a"));
  file.message(1, 1);
  const std::size_t bad = file.records.size();
  for (std::uint64_t time = 2; time < 5; ++time) file.message(1, time);
  file.records[bad + 4] = std::byte{1};  // 16 MiB
  file.closeChunk();
  file.message(1, 5);
  file.closeChunk();
  for (const bool is_cut : {true, false}) {
    SCOPED_TRACE(is_cut);
    damage.clear();
    saveFile(path, is_cut ? file.cut() : file.finished());
    EXPECT_EQ(logTimesOf(Reader(path, tolerant())), (std::vector<std::uint64_t>{1, 5}));
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].messages, 3U) << "the message index has them: " << describe(damage[0]);
    EXPECT_NE(describe(damage[0]).find("all of the 93 bytes from byte " + std::to_string(bad)), std::string::npos)
        << describe(damage[0]);
    EXPECT_THROW((void)logTimesOf(Reader(path)), FormatError);
  }
}

TEST_F(SalvageTest, ALostChunkSaysHowManyMessagesItHeld) {
  IndexedFile file;
  file.channel(channelOf(1, "a"));
  file.channel(channelOf(2, "b"));
  for (std::uint64_t time = 1; time < 8; ++time) file.message(time % 3 == 0 ? 2 : 1, time);
  file.closeChunk();
  const ChunkIndex chunk = file.chunks[0];
  for (const bool is_cut : {true, false}) {
    damage.clear();
    Bytes bytes = is_cut ? file.cut() : file.finished();
    bytes[chunk.chunk_offset + chunk.chunk_length - 1] ^= std::byte{1};
    saveFile(path, bytes);
    EXPECT_TRUE(logTimesOf(Reader(path, tolerant())).empty());
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].messages, 7U);
    EXPECT_EQ(damage[0].length, chunk.chunk_length);
  }
}

TEST_F(SalvageTest, RecoverCountsWhatIsLostAndLeftOut) {
  IndexedFile file;
  for (std::uint64_t chunk = 0; chunk < 5; ++chunk) {
    file.channel(channelOf(1, "a"));
    for (std::uint64_t i = 0; i <= chunk; ++i) file.message(1, 10 * chunk + i);
    file.closeChunk();
    if (chunk == 3) file.attachment("notes.txt", "hello");
    if (chunk == 0) FileBuilder::rawRecord(file.data, 0x90, asBytes("somebody's own"));
  }
  const auto& [one, two, three] = std::tie(file.chunks[1], file.chunks[2], file.chunks[3]);
  for (const bool is_cut : {true, false}) {
    SCOPED_TRACE(is_cut);
    Bytes bytes = is_cut ? file.cut() : file.finished();
    bytes[one.chunk_offset + one.chunk_length - 1] ^= std::byte{1};  // two messages
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(two.chunk_offset),
              bytes.begin() + static_cast<std::ptrdiff_t>(three.chunk_offset), std::byte{0});  // three, and their index
    bytes[file.attachments[0].offset + kRecordHeadBytes + 16 + 3] = std::byte{0x40};           // the length of its name
    saveFile(path, bytes);
    RecoverOptions options;
    options.writer.if_exists = OutputFile::IfExists::kReplace;
    const Recovery found = recover(path, folder.file("out.mcap"), options);
    const std::uint64_t of_cut = is_cut ? 1 : 0;  // and that it was cut
    ASSERT_EQ(found.lost.size(), 3U + of_cut);
    EXPECT_EQ(found.messages, 10U);
    EXPECT_EQ(found.attachments, 0U);
    EXPECT_EQ(found.lost_messages, is_cut ? 2U : 5U) << "of the others nothing is left";
    EXPECT_EQ(found.lost_chunks, is_cut ? 1U : 2U);
    EXPECT_EQ(found.lost_bytes, one.chunk_length + three.chunk_offset - two.chunk_offset + file.attachments[0].length);
    EXPECT_EQ(found.info.unknown_records, 1U);
    EXPECT_FALSE(found.is_whole);
  }
}

TEST_F(SalvageTest, StretchesThatOverlapCountOnce) {
  EXPECT_EQ(lengthOf({{.offset = 10, .length = 10}, {.offset = 12, .length = 3}, {.offset = 15, .length = 10}}), 15U);
  EXPECT_EQ(lengthOf({{.offset = 10, .length = 0}, {.offset = 12, .length = 3}}), 3U);
}

TEST_F(SalvageTest, ABadRecordOutsideOfChunksCostsItselfAlone) {
  const auto write = [](std::uint64_t bad, const std::function<void(Bytes&, std::size_t)>& harm) {
    FileBuilder file;
    appendChannel(file.bytes, channelOf(1, "a"));
    for (std::uint64_t time = 1; time < 9; ++time) {
      const std::size_t begin = file.bytes.size();
      appendMessage(file.bytes, {.channel_id = ChannelId{1}, .log_time_ns = time, .data = asBytes("0123456789")});
      if (time == bad) harm(file.bytes, begin);
    }
    file.finish();
    return file.bytes;
  };
  const auto shorten = [](Bytes& bytes, std::size_t begin) {  // a message of 5 bytes
    bytes.resize(begin);
    FileBuilder::rawRecord(bytes, 0x05, payload(5, 1));
  };
  const auto zero = [](Bytes& bytes, std::size_t begin) {
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.end(), std::byte{0});
  };
  const auto lengthen = [](Bytes& bytes, std::size_t begin) { bytes[begin + 5] = std::byte{1}; };
  for (const auto& harm : {std::function<void(Bytes&, std::size_t)>(shorten), {zero}, {lengthen}}) {
    damage.clear();
    saveFile(path, write(4, harm));
    EXPECT_EQ(logTimesOf(Reader(path, tolerant())), (std::vector<std::uint64_t>{1, 2, 3, 5, 6, 7, 8}));
    EXPECT_EQ(damage.size(), 1U);
    EXPECT_THROW((void)logTimesOf(Reader(path)), FormatError);
  }
}

TEST_F(SalvageTest, ASummaryDeclaresWhatADamagedChunkDeclared) {
  IndexedFile file;
  file.channel(channelOf(1, "a"));
  file.message(1, 1);
  file.closeChunk();
  file.message(1, 2);
  file.closeChunk();
  file.change_summary = [](IndexedFile& f) { f.chunks[1].start_time_ns = 0; };  // so that it is not used otherwise
  Bytes bytes = file.finished();
  bytes[file.chunks[0].chunk_offset + file.chunks[0].chunk_length - 1] ^= std::byte{1};
  saveFile(path, bytes);
  EXPECT_EQ(logTimesOf(Reader(path, tolerant())), std::vector<std::uint64_t>{2});
}

TEST_F(SalvageTest, ASummaryDeclaresThoughItIsNotUsed) {
  struct Harm {
    const char* what;
    std::function<void(Bytes&, const IndexedFile&, std::size_t statistics_at)> apply;
  };
  const std::vector<Harm> harms{
      {"opcode of the first chunk",
       [](Bytes& bytes, const IndexedFile& f, std::size_t) { bytes[f.chunks[0].chunk_offset] ^= std::byte{1}; }},
      {"length of the first chunk",
       [](Bytes& bytes, const IndexedFile& f, std::size_t) { bytes[f.chunks[0].chunk_offset + 1] ^= std::byte{8}; }},
      {"times of the first chunk",
       [](Bytes& bytes, const IndexedFile& f, std::size_t) { bytes[f.chunks[0].chunk_offset + 9] ^= std::byte{64}; }},
      {"plain size of the first chunk",
       [](Bytes& bytes, const IndexedFile& f, std::size_t) { bytes[f.chunks[0].chunk_offset + 25] ^= std::byte{1}; }},
      {"statistics",
       [](Bytes& bytes, const IndexedFile& f, std::size_t statistics_at) {
         bytes[statistics_at] = std::byte{0x7f};
         bytes[f.chunks[0].chunk_offset + f.chunks[0].chunk_length - 1] ^= std::byte{1};
       }},
      {"summary's CRC",
       [](Bytes& bytes, const IndexedFile& f, std::size_t) {
         bytes[bytes.size() - kMagic.size() - 1] = std::byte{1};
         bytes[f.chunks[0].chunk_offset + f.chunks[0].chunk_length - 1] ^= std::byte{1};
       }},
  };
  for (const Harm& harm : harms) {
    IndexedFile file;
    file.channel(channelOf(1, "a"));
    for (std::uint64_t time = 1; time <= 3; ++time) {
      file.message(1, time);
      file.closeChunk();
    }
    std::size_t statistics_at = 0;
    file.change_offsets = [&](SummaryOffset& offset, Footer&) { statistics_at = offset.group_start; };
    Bytes bytes = file.finished();
    harm.apply(bytes, file, statistics_at);
    saveFile(path, bytes);
    damage.clear();
    const std::vector<std::uint64_t> times = logTimesOf(Reader(path, tolerant()));
    EXPECT_EQ(std::vector<std::uint64_t>(times.end() - 2, times.end()), (std::vector<std::uint64_t>{2, 3}))
        << harm.what;
  }
}

TEST_F(SalvageTest, DeclarationsCountWhateverFollowsThem) {
  FileBuilder file;
  Bytes records;
  appendChannel(records, channelOf(1, "a"));
  appendNumber(records, std::uint8_t{0x05});
  appendNumber(records, std::uint64_t{1} << 40);  // a record that does not fit
  file.chunk(records, 0, 0);
  records.clear();
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 3});
  file.chunk(records, 3, 3);
  saveFile(path, file.bytes);
  EXPECT_EQ(logTimesOf(Reader(path, tolerant())), std::vector<std::uint64_t>{3});
  EXPECT_EQ(damage.size(), 1U);
}

TEST_F(SalvageTest, AChunkWhoseOpcodeBecameAFootersEndsNothing) {
  IndexedFile file;
  for (std::uint64_t i = 0; i < 4; ++i) {
    file.channel(channelOf(1, "a"));
    file.message(1, i);
    file.closeChunk();
  }
  Bytes bytes = file.cut();
  bytes[file.chunks[1].chunk_offset] = std::byte{0x02};
  saveFile(path, bytes);
  EXPECT_EQ(logTimesOf(Reader(path, tolerant())), (std::vector<std::uint64_t>{0, 2, 3}));
  EXPECT_FALSE(damage.empty());
}

TEST_F(SalvageTest, AFileThatInflatesWithoutEndIsRefused) {
  const Bytes zeros(1 << 20);
  for (const Compression compression : {Compression::kZstd, Compression::kLz4}) {
    Compressor compressor(compression, 0);
    FileBuilder file;
    append(file.bytes, [] {
      Bytes channel;
      appendChannel(channel, channelOf(1, "a"));
      return channel;
    }());
    Bytes records;
    appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1, .data = zeros});
    for (int i = 0; i < 64; ++i) {
      const ByteView packed = compressor.compress(records);
      appendChunkHead(file.bytes, {.start_time_ns = 1,
                                   .end_time_ns = 1,
                                   .plain_size = records.size(),
                                   .compression = std::string(compressionName(compression)),
                                   .records = packed});
      append(file.bytes, packed);
    }
    file.finish();
    saveFile(path, file.bytes);
    ReaderOptions options = tolerant();
    options.max_inflated_bytes = 65 << 20;
    EXPECT_EQ(samplesOf(Reader(path, options)).size(), 64U);
    options.max_inflated_bytes = 20 << 20;
    if (kMostInflation * file.bytes.size() > 64 << 20) continue;  // lz4: 1 MiB of zeros has 4 KiB
    try {
      const Reader reader(path, options);
      FAIL() << "inflated all of it";
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("mcap decompress"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(damage.empty());
  }
}

}  // namespace
}  // namespace baton::mcap
