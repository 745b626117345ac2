/// What a file system leaves after a crash: blocks of zeros where data were written. They are no sound records.
#include <algorithm>
#include <optional>

#include "indexed_file.hpp"
#include "mcap/copy.hpp"

namespace baton::mcap {
namespace {

const Channel kChannel{.id = ChannelId{1}, .schema_id = kNoSchema, .topic = "a", .message_encoding = "cdr"};

class ZerosTest : public testing::Test {
 protected:
  /// Three chunks of four messages each.
  static void fill(IndexedFile& file) {
    for (std::uint64_t chunk = 0; chunk < 3; ++chunk) {
      file.channel(kChannel);
      for (std::uint64_t i = 0; i < 4; ++i) file.message(1, 10 * chunk + i);
      file.closeChunk();
    }
  }
  void saveWithZeros(Bytes bytes, std::size_t from, std::size_t end) const {
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.begin() + static_cast<std::ptrdiff_t>(end),
              std::byte{0});
    saveFile(path, bytes);
  }
  ReaderOptions tolerant() {
    damage.clear();
    ReaderOptions options;
    options.on_damage = [this](const Damage& one) { damage.push_back(one); };
    return options;
  }
  [[nodiscard]] bool tells(const std::string& words) const {
    return std::ranges::any_of(damage,
                               [&](const Damage& one) { return describe(one).find(words) != std::string::npos; });
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
  std::vector<Damage> damage;
};

TEST_F(ZerosTest, AChunkWhoseBodyIsZeroIsDamagedAndNotEmpty) {
  for (const bool is_cut : {true, false}) {
    SCOPED_TRACE(is_cut);
    IndexedFile file;
    fill(file);
    const ChunkIndex chunk = file.chunks[1];
    // All of it, and its fields alone.
    for (const std::uint64_t bytes : {chunk.chunk_length - kRecordHeadBytes, std::uint64_t{40}}) {
      const std::size_t from = chunk.chunk_offset + kRecordHeadBytes;
      saveWithZeros(is_cut ? file.cut() : file.finished(), from, from + bytes);
      EXPECT_EQ(samplesOf(Reader(path, tolerant())).size(), 8U);
      ASSERT_EQ(damage.size(), 1U);
      EXPECT_EQ(damage[0].offset, chunk.chunk_offset);
      EXPECT_EQ(damage[0].length, chunk.chunk_length);
      EXPECT_TRUE(tells(" zero bytes")) << describe(damage[0]);
      EXPECT_THROW((void)samplesOf(Reader(path)), FormatError) << "messages are missing, and nobody says so";
    }
  }
}

TEST_F(ZerosTest, ZerosBetweenRecordsAreDamageWithTheirPlaceAndSize) {
  for (const bool is_cut : {true, false}) {
    SCOPED_TRACE(is_cut);
    IndexedFile file;
    fill(file);
    const std::size_t from = file.chunks[1].chunk_offset, end = file.chunks[2].chunk_offset;
    saveWithZeros(is_cut ? file.cut() : file.finished(), from, end);
    EXPECT_EQ(samplesOf(Reader(path, tolerant())).size(), 8U);
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].offset, from);
    EXPECT_EQ(damage[0].length, end - from);
    EXPECT_TRUE(tells(std::to_string(end - from) + " zero bytes")) << describe(damage[0]);
    EXPECT_THROW((void)samplesOf(Reader(path)), FormatError) << "it is no cut: a chunk follows";
  }
}

TEST_F(ZerosTest, ZerosToTheEndAreACutWithTheirSize) {
  IndexedFile file;
  fill(file);
  const std::size_t from = file.chunks[2].chunk_offset;
  saveWithZeros(file.finished(), from, file.finished().size());
  const Reader reader(path);
  EXPECT_FALSE(reader.info().is_complete);
  EXPECT_EQ(reader.info().complete_bytes, from);
  EXPECT_NE(reader.info().problem.find(" zero bytes"), std::string::npos) << reader.info().problem;
}

TEST_F(ZerosTest, ZerosAmongTheRecordsOfAChunkAreDamage) {
  Bytes records;
  appendChannel(records, kChannel);
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1});
  records.resize(records.size() + 10 * kRecordHeadBytes);  // as many records of kind 0 and length 0
  FileBuilder file;
  appendChunkHead(file.bytes, {.start_time_ns = 1, .end_time_ns = 1, .plain_size = records.size(), .records = records});
  append(file.bytes, records);
  file.finish();
  saveFile(path, file.bytes);
  (void)samplesOf(Reader(path, tolerant()));
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_TRUE(tells("90 zero bytes")) << describe(damage[0]);
  EXPECT_THROW((void)samplesOf(Reader(path)), FormatError);
}

TEST_F(ZerosTest, DeclarationsThatAreZeroAreDamage) {
  for (const bool is_schema : {true, false}) {
    Bytes records;
    FileBuilder::rawRecord(records, is_schema ? 0x03 : 0x04, Bytes(50));
    appendChannel(records, kChannel);
    FileBuilder file;
    append(file.bytes, records);
    file.finish();
    saveFile(path, file.bytes);
    const Reader reader(path, tolerant());
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_TRUE(tells("50 zero bytes")) << describe(damage[0]);
  }
}

TEST_F(ZerosTest, AttachmentsMetadataAndIndexesThatAreZeroAreDamage) {
  IndexedFile file;
  fill(file);
  file.attachment("notes.txt", "hello");
  file.addMetadata("run");
  const std::size_t index = file.chunks[0].chunk_offset + file.chunks[0].chunk_length;
  struct Place {
    std::size_t offset, length;
  };
  const std::vector<Place> places{{file.attachments[0].offset, file.attachments[0].length},
                                  {file.metadata[0].offset, file.metadata[0].length},
                                  {index, file.chunks[0].message_index_length}};
  const Bytes finished = file.finished();
  for (const Place& place : places) {
    for (const Bytes& bytes : {file.cut(), finished}) {
      SCOPED_TRACE(place.offset);
      saveWithZeros(bytes, place.offset + kRecordHeadBytes, place.offset + place.length);
      const Reader reader(path, tolerant());
      EXPECT_EQ(samplesOf(reader).size(), 12U);
      ASSERT_EQ(damage.size(), 1U);
      EXPECT_EQ(damage[0].offset, place.offset);
      EXPECT_EQ(damage[0].length, place.length);
    }
  }
}

TEST_F(ZerosTest, ZerosAfterTheLastChunkAreDamageAndTheIndexIsReached) {
  IndexedFile file;
  fill(file);
  const std::size_t from = file.chunks[2].chunk_offset + file.chunks[2].chunk_length;
  const Bytes finished = file.finished();
  saveWithZeros(finished, from, file.cut().size());
  const Reader reader(path, tolerant());
  EXPECT_TRUE(reader.info().is_complete) << reader.info().problem;
  EXPECT_EQ(samplesOf(reader).size(), 12U);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_EQ(damage[0].offset, from);
  EXPECT_EQ(damage[0].length, file.cut().size() - from);
}

TEST_F(ZerosTest, NoZerosAnywhereTakeAnythingWithoutAWord) {
  {
    WriterOptions options;
    options.compression = Compression::kNone;
    options.chunk_bytes = 300;
    options.sync_on_close = false;
    Writer writer(path, options);
    const ChannelId a = writer.addChannel("a", "cdr", writer.addSchema("T", "omgidl", asBytes("struct T {};")));
    for (unsigned i = 0; i < 16; ++i) {
      writer.write(a, i, i + 1, i, payload(30, i + 1));
      if (i == 5) writer.addMetadata("m", {{"k", "v"}});
      if (i == 8) writer.addAttachment("file", "text/plain", 1, 2, asBytes("some data"));
    }
    writer.addMetadata("end", {{"k", "v"}});
    writer.close();
  }
  const Bytes file = loadFile(path);
  const std::vector<Sample> all = samplesOf(Reader(path));
  const std::vector<RawRecord> records = rawRecords(file);
  const std::size_t data_end = std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset;
  for (const std::size_t size : {std::size_t{9}, std::size_t{64}, std::size_t{512}, file.size()}) {
    for (std::size_t from = kMagic.size(); from < data_end; from += 5) {
      SCOPED_TRACE(std::to_string(size) + " zeros from byte " + std::to_string(from));
      saveWithZeros(file, from, std::min(from + size, file.size()));
      const Reader reader(path, tolerant());
      const std::vector<Sample> samples = samplesOf(reader);
      const bool is_sound = samples == all && reader.metadataIndexes().size() == 2 && reader.attachments().size() == 1;
      try {
        (void)reader.metadata();
        for (const AttachmentIndex& one : reader.attachments()) (void)reader.readAttachment(one);
      } catch (const FormatError&) {
        continue;  // told
      }
      const FileInfo& info = reader.info();
      const bool is_told = !damage.empty() || !info.problem.empty() || !info.contradictions.empty();
      ASSERT_TRUE(is_sound || is_told) << samples.size() << " of " << all.size() << " messages";
      for (const Sample& sample : samples) ASSERT_EQ(sample, all[sample.sequence]);
    }
  }
}

}  // namespace
}  // namespace baton::mcap
