/// Recordings that were cut off, damaged or made to mislead.
#include <algorithm>

#include "recording.hpp"

namespace baton::mcap {
namespace {

class DamageTest : public testing::TestWithParam<Compression> {
 protected:
  /// A few chunks, with metadata and an attachment between them.
  [[nodiscard]] Bytes smallRecording(bool has_crc = true) const {
    WriterOptions options;
    options.library = "t";
    options.compression = GetParam();
    options.chunk_bytes = 200;
    options.has_crc = has_crc;
    options.sync_on_close = false;
    options.if_exists = OutputFile::IfExists::kReplace;
    Writer writer(path, options);
    const SchemaId schema = writer.addSchema("T", "omgidl", asBytes("struct T {};"));
    const ChannelId a = writer.addChannel("a", "cdr", schema, {{"k", "v"}});
    const ChannelId b = writer.addChannel("b", "cdr", schema);
    for (unsigned i = 0; i < 12; ++i) {
      writer.write(i % 3 == 0 ? b : a, i, i + 1, i, payload(10, i));
      if (i == 5) writer.addMetadata("m", {{"k", "v"}});
      if (i == 8) writer.addAttachment("file", "text/plain", 1, 2, asBytes("data"));
    }
    writer.close();
    return loadFile(path);
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
};

INSTANTIATE_TEST_SUITE_P(Compressions, DamageTest,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd),
                         [](const auto& tested) {
                           return tested.param == Compression::kNone ? std::string("none")
                                                                     : std::string(compressionName(tested.param));
                         });

TEST_P(DamageTest, CutAnywhereDeliversExactlyTheWholeChunks) {
  const Bytes file = smallRecording();
  const std::vector<Sample> all = samplesOf(Reader(path));
  ASSERT_EQ(all.size(), 12U);
  // By hand: after how many bytes how many messages are in whole chunks, and where each record ends.
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord data_end = *std::ranges::find(records, 0x0F, &RawRecord::opcode);
  std::vector<std::pair<std::size_t, std::size_t>> whole{{0, 0}};
  for (const RawRecord& record : records) {
    if (record.opcode != 0x06) continue;
    const Chunk chunk = decodeChunk(record.body);
    whole.emplace_back(record.end(),
                       whole.back().second + static_cast<std::size_t>(chunk.end_time_ns - chunk.start_time_ns + 1));
  }
  ASSERT_GE(whole.size(), 4U);
  ASSERT_EQ(whole.back().second, 12U);

  const std::filesystem::path cut_path = folder.file("cut.mcap");
  saveFile(cut_path, file);
  for (std::size_t size = file.size(); size-- > 0;) {
    SCOPED_TRACE("cut after " + std::to_string(size) + " of " + std::to_string(file.size()) + " bytes");
    std::filesystem::resize_file(cut_path, size);
    if (size < kMagic.size()) {
      EXPECT_THROW(Reader{cut_path}, FormatError);
      continue;
    }
    const Reader reader(cut_path);
    std::size_t expected = 0;
    for (const auto& [end, count] : whole) {
      if (end <= size) expected = count;
    }
    const std::vector<Sample> samples = samplesOf(reader);
    ASSERT_EQ(samples, std::vector<Sample>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(expected)));
    EXPECT_EQ(reader.statistics().message_count, expected);
    EXPECT_FALSE(reader.info().is_complete);
    EXPECT_NE(reader.info().problem.find("cut at byte"), std::string::npos) << reader.info().problem;
    std::size_t complete = kMagic.size();
    for (const RawRecord& record : records) {
      if (record.end() <= size) complete = record.end();
    }
    EXPECT_EQ(reader.info().complete_bytes, complete);
    EXPECT_EQ(reader.dataCrcMatches().has_value(), size >= data_end.end());
    EXPECT_EQ(reader.info().has_all_data, size >= data_end.end());
    EXPECT_TRUE(reader.dataCrcMatches().value_or(true));
    for (const AttachmentIndex& attachment : reader.attachments()) {
      EXPECT_EQ(reader.readAttachment(attachment).size(), 4U);
    }
    EXPECT_LE(reader.metadata().size(), 1U);
  }
}

TEST_P(DamageTest, ZerosAtTheEndAreACut) {  // what a machine that lost power leaves behind
  Bytes file = smallRecording();
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord data_end = *std::ranges::find(records, 0x0F, &RawRecord::opcode);
  std::fill(file.begin() + static_cast<std::ptrdiff_t>(data_end.offset), file.end(), std::byte{0});
  saveFile(path, file);
  const Reader reader(path);
  EXPECT_FALSE(reader.info().is_complete);
  EXPECT_EQ(reader.info().complete_bytes, data_end.offset);
  EXPECT_EQ(samplesOf(reader).size(), 12U);
}

TEST_P(DamageTest, BytesBehindTheEndAreNoted) {
  Bytes file = smallRecording();
  const std::size_t size = file.size();
  append(file, asBytes("xyz"));
  saveFile(path, file);
  const Reader reader(path);
  EXPECT_FALSE(reader.info().is_complete);
  EXPECT_EQ(reader.info().complete_bytes, size);
  EXPECT_NE(reader.info().problem.find("3 bytes follow"), std::string::npos) << reader.info().problem;
  EXPECT_EQ(samplesOf(reader).size(), 12U);
}

TEST_P(DamageTest, AFlippedByteInAChunkIsReportedWithItsPlace) {
  const Bytes file = smallRecording();
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord chunk = *std::ranges::find(records, 0x06, &RawRecord::opcode);
  const std::size_t data_size = decodeChunk(chunk.body).records.size();
  const std::string place = "chunk at byte " + std::to_string(chunk.offset);
  for (std::size_t at = chunk.end() - data_size; at < chunk.end(); ++at) {
    Bytes damaged = file;
    damaged[at] ^= std::byte{0x10};
    saveFile(path, damaged);
    const Reader reader(path);
    std::string message;
    try {
      const std::vector<Sample> samples = samplesOf(reader);
      // Bits a decoder does not look at may be flipped without changing what comes out.
      EXPECT_EQ(samples.size(), 12U);
      EXPECT_NE(GetParam(), Compression::kNone);
      continue;
    } catch (const FormatError& error) {
      message = error.what();
    }
    EXPECT_NE(message.find(place), std::string::npos) << message;
    EXPECT_EQ(reader.dataCrcMatches(), false);
    // The rest can be had by those who ask for it.
    std::vector<Damage> damages;
    ReaderOptions options;
    options.on_damage = [&](const Damage& damage) { damages.push_back(damage); };
    EXPECT_LT(samplesOf(Reader(path, options)).size(), 12U);
    ASSERT_EQ(damages.size(), 1U);
    EXPECT_EQ(damages[0].offset, chunk.offset);
    EXPECT_EQ(damages[0].length, chunk.end() - chunk.offset);
  }
}

TEST_P(DamageTest, ADamagedSummaryIsReplacedByAScan) {
  const Bytes file = smallRecording();
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord data_end = *std::ranges::find(records, 0x0F, &RawRecord::opcode);
  // In the body of the first summary record, a schema: its length stays right, so the file is still walked to its end.
  Bytes damaged = file;
  damaged[data_end.end() + 9 + 6] ^= std::byte{1};
  saveFile(path, damaged);
  const Reader reader(path);
  EXPECT_FALSE(reader.info().has_summary);
  EXPECT_TRUE(reader.info().is_complete);
  EXPECT_NE(reader.info().problem.find("summary is damaged"), std::string::npos) << reader.info().problem;
  EXPECT_EQ(samplesOf(reader).size(), 12U);
  EXPECT_EQ(reader.schemas().begin()->second.name, "T");
}

/// In place: writing thousands of files anew would take seconds.
void changeByte(const std::filesystem::path& path, std::size_t at, std::byte value) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(at));
  file.put(static_cast<char>(value));
}

/// Opens, reads everything, and lets only our own errors out.
void readEverything(const std::filesystem::path& path, const ReaderOptions& options) {
  try {
    const Reader reader(path, options);
    try {
      for (const Sample& sample : samplesOf(reader)) ASSERT_LE(sample.data.size(), 1U << 20);
    } catch (const FormatError&) {
    }
    try {
      static_cast<void>(reader.metadata());
      for (const AttachmentIndex& attachment : reader.attachments()) {
        static_cast<void>(reader.readAttachment(attachment));
      }
    } catch (const FormatError&) {
    }
    static_cast<void>(reader.dataCrcMatches());
  } catch (const FormatError&) {
  }
}

TEST_P(DamageTest, NoChangedByteLeadsAstray) {
  const std::filesystem::path damaged_path = folder.file("damaged.mcap");
  ReaderOptions trusting;
  trusting.check_crc = false;  // so that the damage reaches the decoders
  trusting.max_chunk_bytes = 1 << 20;
  ReaderOptions tolerant = trusting;
  tolerant.on_damage = [](const Damage&) {};
  for (const bool has_crc : {true, false}) {
    const Bytes file = smallRecording(has_crc);
    saveFile(damaged_path, file);
    for (std::size_t at = kMagic.size(); at < file.size(); ++at) {
      for (const std::byte value : {std::byte{0x00}, std::byte{0xFF}, file[at] ^ std::byte{0x01}}) {
        if (value == file[at]) continue;
        SCOPED_TRACE("byte " + std::to_string(at));
        changeByte(damaged_path, at, value);
        readEverything(damaged_path, trusting);
        readEverything(damaged_path, tolerant);
        if (has_crc) readEverything(damaged_path, {});
      }
      changeByte(damaged_path, at, file[at]);
    }
  }
}

TEST_P(DamageTest, AChunkCannotHoldMoreOrLessThanItSays) {
  Bytes records;
  appendChannel(records, {.id = ChannelId{1}, .topic = "t", .message_encoding = ""});
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1, .data = payload(5000, 1)});
  Compressor compressor(GetParam(), 0);
  const ByteView packed = compressor.compress(records);
  const std::uint64_t exact = records.size();
  for (const std::uint64_t claimed : {std::uint64_t{0}, exact - 1, exact, exact + 1, std::uint64_t{1} << 29,
                                      std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    SCOPED_TRACE(claimed);
    FileBuilder file;
    appendChunkHead(file.bytes, {.start_time_ns = 1,
                                 .end_time_ns = 1,
                                 .plain_size = claimed,
                                 .compression = std::string(compressionName(GetParam())),
                                 .records = packed});
    append(file.bytes, packed);
    file.finish();
    saveFile(path, file.bytes);
    if (claimed == exact) {
      EXPECT_EQ(samplesOf(Reader(path)).size(), 1U);
    } else {
      EXPECT_THROW(Reader{path}, FormatError);
    }
  }
}

class PlainDamageTest : public DamageTest {};
INSTANTIATE_TEST_SUITE_P(None, PlainDamageTest, testing::Values(Compression::kNone));

TEST_P(PlainDamageTest, RecordsInAChunkStayInside) {
  Bytes records;
  appendChannel(records, {.id = ChannelId{1}, .topic = "t", .message_encoding = ""});
  appendNumber(records, std::uint8_t{0x05});
  appendNumber(records, ~std::uint64_t{0} - 4);  // a length that wraps round when added to
  FileBuilder file;
  file.chunk(records, 0, 0);
  file.finish();
  saveFile(path, file.bytes);
  EXPECT_THROW(Reader{path}, FormatError);
}

TEST_P(PlainDamageTest, ARecordTooLongForTheFileIsACut) {
  for (const std::uint64_t length :
       {std::uint64_t{1}, std::uint64_t{1} << 40, ~std::uint64_t{0}, ~std::uint64_t{0} - 8}) {
    FileBuilder file;
    const std::size_t begin = file.bytes.size();
    appendNumber(file.bytes, std::uint8_t{0x06});
    appendNumber(file.bytes, length);
    saveFile(path, file.bytes);
    const Reader reader(path);
    EXPECT_FALSE(reader.info().is_complete);
    EXPECT_EQ(reader.info().complete_bytes, begin);
  }
}

TEST_P(PlainDamageTest, AnUnknownCompressionIsNamed) {
  for (const std::string name : {"rar", "snappy", "a-compression-of-its-own"}) {
    FileBuilder file;
    appendChunkHead(file.bytes, {.compression = name});
    Bytes records;
    appendChannel(records, {.id = ChannelId{1}, .topic = "a"});
    appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1});
    file.chunk(records, 1, 1);
    file.finish();
    saveFile(path, file.bytes);
    try {
      const Reader reader(path);
      FAIL();
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find('"' + name + '"'), std::string::npos) << error.what();
    }
    std::vector<Damage> damage;
    ReaderOptions options;
    options.on_damage = [&](const Damage& found) { damage.push_back(found); };
    EXPECT_EQ(samplesOf(Reader(path, options)).size(), 1U);
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_NE(damage[0].reason.find('"' + name + '"'), std::string::npos) << damage[0].reason;
    EXPECT_EQ(damage[0].chunks, 1U);
  }
}

TEST_P(PlainDamageTest, ASummaryCannotListAChunkManyTimes) {
  // A thousand entries for one chunk would multiply the work of reading it.
  FileBuilder file;
  Bytes records;
  appendChannel(records, {.id = ChannelId{1}, .topic = "t", .message_encoding = ""});
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1});
  const std::size_t chunk_at = file.bytes.size();
  file.chunk(records, 1, 1);
  const std::size_t chunk_end = file.bytes.size();
  appendDataEnd(file.bytes, {});
  const std::size_t summary_start = file.bytes.size();
  append(file.bytes, ByteView(records).first(records.size() - kMessageHeadBytes));
  appendStatistics(file.bytes, {.message_count = 1000,
                                .channel_count = 1,
                                .chunk_count = 1000,
                                .channel_message_counts = {{ChannelId{1}, 1000}}});
  for (int i = 0; i < 1000; ++i) {
    appendChunkIndex(file.bytes, {.chunk_offset = chunk_at, .chunk_length = chunk_end - chunk_at});
  }
  appendFooter(file.bytes, {.summary_start = summary_start});
  append(file.bytes, kMagic);
  saveFile(path, file.bytes);
  const Reader reader(path);
  EXPECT_FALSE(reader.info().has_summary);
  EXPECT_EQ(samplesOf(reader).size(), 1U);
}

TEST_P(PlainDamageTest, DamageIsReportedWhenTheFileIsOpenedAndOnce) {
  const Bytes file = smallRecording();
  const std::vector<RawRecord> records = rawRecords(file);
  for (const std::uint8_t opcode : {std::uint8_t{0x06}, std::uint8_t{0x09}, std::uint8_t{0x0C}}) {
    SCOPED_TRACE(static_cast<int>(opcode));
    const RawRecord record = *std::ranges::find(records, opcode, &RawRecord::opcode);
    Bytes damaged = file;
    // The last byte of a chunk; lengths in the others.
    damaged[opcode == 0x06   ? record.end() - 1
            : opcode == 0x09 ? record.offset + 9 + 16 + 3
                             : record.offset + 9 + 3] ^= std::byte{0x40};
    saveFile(path, damaged);
    std::vector<Damage> damages;
    ReaderOptions options;
    options.on_damage = [&](const Damage& damage) { damages.push_back(damage); };
    const Reader reader(path, options);
    ASSERT_EQ(damages.size(), 1U) << "nobody who reads a topic of another chunk would know";
    EXPECT_EQ(damages[0].offset, record.offset);
    (void)samplesOf(reader);
    (void)samplesOf(reader);
    EXPECT_EQ(damages.size(), 1U);
  }
}

TEST_P(PlainDamageTest, ADamagedAttachmentIsReported) {
  Bytes file = smallRecording();
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord attachment = *std::ranges::find(records, 0x09, &RawRecord::opcode);
  file[attachment.end() - 6] ^= std::byte{1};
  saveFile(path, file);
  const Reader reader(path);
  try {
    static_cast<void>(reader.readAttachment(reader.attachments().at(0)));
    FAIL();
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("Attachment at byte " + std::to_string(attachment.offset)),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace baton::mcap
