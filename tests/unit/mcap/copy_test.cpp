/// What is made of a recording that was cut or damaged, at whatever place.
#include "mcap/copy.hpp"

#include <algorithm>
#include <memory>
#include <set>

#include "recording.hpp"

namespace baton::mcap {
namespace {

class RecoverTest : public testing::TestWithParam<Compression> {
 protected:
  /// A few chunks, with metadata and attachments at its begin, in its middle and at its end.
  [[nodiscard]] Bytes smallRecording() const {
    WriterOptions options;
    options.profile = "p";
    options.compression = GetParam();
    options.chunk_bytes = 200;
    options.sync_on_close = false;
    Writer writer(path, options);
    writer.addMetadata("run", {{"k", "v"}});
    writer.addAttachment("scenario", "text/plain", 1, 2, asBytes("first"));
    const SchemaId schema = writer.addSchema("T", "omgidl", asBytes("struct T {};"));
    const ChannelId a = writer.addChannel("a", "cdr", schema, {{"writer", "1"}});
    const ChannelId b = writer.addChannel("b", "cdr", kNoSchema);
    writer.addChannel("silent", "cdr", schema);
    for (unsigned i = 0; i < 12; ++i) {
      writer.write(i % 3 == 0 ? b : a, i, i + 1, i, payload(10, i));
      if (i == 5) writer.addMetadata("middle", {{"k", "v"}});
    }
    writer.addMetadata("certificate", {{"complete", "true"}});
    writer.addAttachment("certificate.json", "text/plain", 1, 2, asBytes("last"));
    writer.close();
    return loadFile(path);
  }
  [[nodiscard]] Recovery recovered() const {
    RecoverOptions options;
    options.writer.sync_on_close = false;
    options.lossy_name = [](const std::string& name) { return "original " + name; };
    std::filesystem::remove(out);
    return recover(path, out, options);
  }
  /// As strict as the official reader: finished, indexed, every CRC right, in its order.
  [[nodiscard]] std::vector<Sample> checkedSamples() const {
    const Reader reader(out);
    EXPECT_TRUE(reader.info().is_complete);
    EXPECT_TRUE(reader.info().has_summary);
    EXPECT_EQ(reader.info().problem, "");
    EXPECT_EQ(reader.dataCrcMatches(), true);
    std::vector<Sample> samples = samplesOf(reader, {.order = MessageFilter::Order::kFile});
    EXPECT_EQ(samples.size(), reader.statistics().message_count);
    return samples;
  }
  [[nodiscard]] static std::set<std::string> namesIn(const Reader& reader) {
    std::set<std::string> names;
    for (const Metadata& one : reader.metadata()) names.insert(one.name);
    for (const AttachmentIndex& one : reader.attachments()) {
      names.insert(one.name);
      EXPECT_FALSE(reader.readAttachment(one).empty());
    }
    return names;
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
  std::filesystem::path out = folder.file("out.mcap");
};

INSTANTIATE_TEST_SUITE_P(Compressions, RecoverTest,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd),
                         [](const auto& tested) {
                           return tested.param == Compression::kNone ? std::string("none")
                                                                     : std::string(compressionName(tested.param));
                         });

TEST_P(RecoverTest, AWholeRecordingIsCopiedAndNothingIsLost) {
  (void)smallRecording();
  const Recovery found = recovered();
  EXPECT_TRUE(found.lost.empty());
  EXPECT_TRUE(found.is_whole);
  EXPECT_EQ(found.messages, 12U);
  EXPECT_EQ(found.metadata, 3U);
  EXPECT_EQ(found.attachments, 2U);
  EXPECT_EQ(checkedSamples(), samplesOf(Reader(path)));
  const Reader before(path), after(out);
  EXPECT_EQ(after.channels(), before.channels());
  EXPECT_EQ(after.schemas(), before.schemas());
  EXPECT_EQ(after.info().header.profile, "p");
  EXPECT_EQ(namesIn(after), namesIn(before));
}

TEST_P(RecoverTest, CutAnywhereItGivesWhatCanBeReadAndSaysWhatIsLost) {
  const Bytes file = smallRecording();
  const std::vector<RawRecord> records = rawRecords(file);
  const RawRecord data_end = *std::ranges::find(records, 0x0F, &RawRecord::opcode);
  for (std::size_t size = file.size(); size-- > 0;) {
    SCOPED_TRACE("cut after " + std::to_string(size) + " of " + std::to_string(file.size()) + " bytes");
    std::filesystem::resize_file(path, size);
    if (size < kMagic.size()) {
      std::filesystem::remove(out);
      EXPECT_THROW((void)recovered(), FormatError);
      EXPECT_FALSE(std::filesystem::exists(out));
      continue;
    }
    const Reader cut(path);
    const Recovery found = recovered();
    ASSERT_EQ(checkedSamples(), samplesOf(cut));
    const Reader after(out);
    EXPECT_EQ(after.channels().size(), cut.channels().size());
    EXPECT_EQ(after.attachments().size(), cut.attachments().size());
    EXPECT_EQ(after.metadata().size(), cut.metadata().size());
    // Behind the end of the data there is only the index, and that is made again.
    EXPECT_EQ(found.lost.empty(), size >= data_end.end());
    if (found.lost.empty()) {
      EXPECT_EQ(found.messages, 12U);
      EXPECT_TRUE(namesIn(after).contains("certificate"));
      continue;
    }
    EXPECT_FALSE(namesIn(after).contains("certificate")) << "it claims more than is there";
    ASSERT_EQ(found.lost.size(), 1U);
    EXPECT_EQ(found.lost[0].offset, found.info.complete_bytes);
    EXPECT_EQ(found.lost[0].offset + found.lost[0].length, size);
  }
}

TEST_P(RecoverTest, AnyChangedByteCostsAtMostTheChunkItIsIn) {
  const Bytes file = smallRecording();
  const std::vector<Sample> all = samplesOf(Reader(path));
  const std::vector<RawRecord> records = rawRecords(file);
  std::size_t largest = 0;
  for (const RawRecord& record : records) {
    if (record.opcode != 0x06) continue;
    const Chunk chunk = decodeChunk(record.body);
    largest = std::max<std::size_t>(largest, chunk.end_time_ns - chunk.start_time_ns + 1);
  }
  const std::size_t data_end = std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset;
  for (const bool is_cut : {false, true}) {  // with and without an index to help
    for (std::size_t at = kMagic.size(); at < data_end; ++at) {
      SCOPED_TRACE((is_cut ? "without index, byte " : "byte ") + std::to_string(at));
      Bytes damaged(file.begin(), is_cut ? file.begin() + static_cast<std::ptrdiff_t>(data_end) : file.end());
      damaged[at] ^= std::byte{0x20};
      saveFile(path, damaged);
      const Recovery found = recovered();
      const std::vector<Sample> samples = checkedSamples();
      EXPECT_GE(samples.size() + largest, all.size());
      EXPECT_EQ(samples.size(), found.messages);
      // What is there is what was there, in its order.
      EXPECT_TRUE(std::ranges::includes(all, samples, {}, &Sample::sequence, &Sample::sequence));
      for (const Sample& sample : samples) ASSERT_EQ(sample, all[sample.sequence]);
      EXPECT_FALSE(found.is_whole);
      EXPECT_FALSE(found.lost.empty() && samples.size() < all.size()) << "a loss that nobody hears of";
    }
  }
}

TEST_P(RecoverTest, AHoleInTheMiddleOfACutFileIsSteppedOver) {
  // A machine that lost power may leave blocks of zeros between others.
  const Bytes file = smallRecording();
  const std::vector<Sample> all = samplesOf(Reader(path));
  const std::vector<RawRecord> records = rawRecords(file);
  const std::size_t data_end = std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset;
  std::vector<RawRecord> chunks;
  std::ranges::copy_if(records, std::back_inserter(chunks), [](const RawRecord& one) { return one.opcode == 0x06; });
  ASSERT_GE(chunks.size(), 4U);
  Bytes damaged(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(data_end));
  std::fill(damaged.begin() + static_cast<std::ptrdiff_t>(chunks[1].offset + 20),
            damaged.begin() + static_cast<std::ptrdiff_t>(chunks[2].offset + 3), std::byte{0});
  saveFile(path, damaged);
  const Recovery found = recovered();
  const std::vector<Sample> samples = checkedSamples();
  const auto last_of = [&](std::size_t i) { return decodeChunk(chunks[i].body).end_time_ns; };
  std::vector<Sample> expected = all;
  std::erase_if(expected,
                [&](const Sample& one) { return one.log_time_ns > last_of(0) && one.log_time_ns <= last_of(2); });
  EXPECT_EQ(samples, expected);
  ASSERT_EQ(found.lost.size(), 2U);
  const RawRecord middle = *std::ranges::find_if(
      records, [&](const RawRecord& one) { return one.opcode == 0x0C && one.offset > chunks[2].offset; });
  EXPECT_LT(middle.offset, chunks[3].offset);
  EXPECT_EQ(found.lost[0].offset, chunks[1].offset);
  EXPECT_EQ(found.lost[0].offset + found.lost[0].length, middle.offset);
  EXPECT_EQ(found.metadata, 3U);
  EXPECT_EQ(found.lost[1].offset, data_end) << "and that it was cut";
}

TEST_P(RecoverTest, ARecordingInAnAttachmentIsNotMistakenForThisOne) {
  const Bytes inner = smallRecording();
  const auto write = [&] {
    std::filesystem::remove(path);
    WriterOptions options;
    options.compression = GetParam();
    Writer writer(path, options);
    const ChannelId a = writer.addChannel("a", "cdr", kNoSchema);
    for (std::uint32_t i = 0; i < 4; ++i) {
      writer.write(a, 100 + i, 100 + i, 0, payload(10, i));
      writer.addAttachment("file" + std::to_string(i), "application/mcap", 1, 2, inner);
    }
    writer.close();
    return loadFile(path);
  };
  const Bytes file = write();
  const std::vector<Sample> all = samplesOf(Reader(path));
  const std::vector<RawRecord> records = rawRecords(file);
  std::vector<std::size_t> attachments, chunks;
  for (const RawRecord& record : records) {
    if (record.opcode == 0x09) attachments.push_back(record.offset);
    if (record.opcode == 0x06) chunks.push_back(record.offset);
  }
  ASSERT_EQ(attachments.size(), 4U);
  ASSERT_EQ(chunks.size(), 4U);
  const std::size_t data_end = std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset;
  // Damaged lengths of a chunk in front of an attachment, and of an attachment itself; without an index.
  for (const std::size_t place : {chunks[1], attachments[1]}) {
    for (std::size_t at = place; at < place + 9; ++at) {
      SCOPED_TRACE("byte " + std::to_string(at));
      Bytes damaged(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(data_end));
      damaged[at] ^= std::byte{0x01};
      saveFile(path, damaged);
      const Recovery found = recovered();
      EXPECT_FALSE(found.lost.empty());
      std::vector<Sample> expected = all;
      if (place == chunks[1]) expected.erase(expected.begin() + 1);
      EXPECT_EQ(checkedSamples(), expected);
      EXPECT_EQ(found.attachments, place == chunks[1] ? 4U : 3U);
    }
  }
}

TEST_P(RecoverTest, AnIndexOfWrongLengthCostsNothingBehindIt) {
  const Bytes file = smallRecording();
  const std::vector<Sample> all = samplesOf(Reader(path));
  const std::vector<RawRecord> records = rawRecords(file);
  const std::size_t data_end = std::ranges::find(records, 0x0F, &RawRecord::opcode)->offset;
  const RawRecord index = *std::ranges::find(records, 0x07, &RawRecord::opcode);
  Bytes damaged(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(data_end));
  damaged[index.offset + 2] ^= std::byte{0x01};  // 256 bytes more: over chunks that are sound
  saveFile(path, damaged);
  const Recovery found = recovered();
  EXPECT_EQ(checkedSamples(), all);
  EXPECT_FALSE(found.is_whole);
}

TEST_P(RecoverTest, NeverOverwritesWhatIsThere) {
  (void)smallRecording();
  saveFile(out, asBytes("precious"));
  EXPECT_THROW(recover(path, out, {}), UnavailableError);
  EXPECT_EQ(loadFile(out).size(), 8U);
}

TEST_P(RecoverTest, ACopyThatCannotBeFinishedIsRemoved) {
  (void)smallRecording();
  const auto fail = [&] {
    Copier copy(out);
    throw WriteError("no room");
  };
  EXPECT_THROW(fail(), WriteError);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_P(RecoverTest, ACopyThatCannotBeFinishedLeavesWhatItWasToReplace) {
  (void)smallRecording();
  saveFile(out, asBytes("precious"));
  const auto fail = [&] {
    WriterOptions options;
    options.if_exists = OutputFile::IfExists::kReplace;
    Copier copy(out, options);
    throw WriteError("no room");
  };
  EXPECT_THROW(fail(), WriteError);
  EXPECT_EQ(loadFile(out).size(), 8U);
}

TEST(Copier, AnIdWithManyMeaningsIsCopiedWithAllOfThem) {
  constexpr std::uint64_t kMeanings = 60'000;  // each was compared with all before it
  const TemporaryFolder folder;
  FileBuilder file;
  for (std::uint64_t i = 0; i < kMeanings; ++i) {
    appendSchema(file.bytes, {.id = SchemaId{1}, .name = std::to_string(i), .encoding = "omgidl", .data = {}});
    appendChannel(file.bytes, {.id = ChannelId{1}, .schema_id = SchemaId{1}, .topic = std::to_string(i)});
    appendMessage(file.bytes, {.channel_id = ChannelId{1}, .log_time_ns = i});
  }
  file.finish();
  saveFile(folder.file("in"), file.bytes);
  RecoverOptions options;
  options.writer.sync_on_close = false;
  EXPECT_EQ(recover(folder.file("in"), folder.file("out"), options).messages, kMeanings);
  const Reader copy(folder.file("out"));
  EXPECT_EQ(copy.channels().size(), kMeanings);
  EXPECT_EQ(copy.schemas().size(), kMeanings);
}

TEST(Copier, EqualChannelsOfSeveralFilesAreOne) {
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  std::vector<std::unique_ptr<Reader>> readers;
  for (const char* writer : {"1", "2", "1"}) {
    files.push_back(folder.file("in" + std::to_string(files.size())));
    Writer one(files.back());
    one.addSchema("Other", "omgidl", {});  // so that the numbers differ
    if (files.size() > 1) one.addSchema("Another", "omgidl", {});
    const SchemaId schema = one.addSchema("T", "omgidl", asBytes("struct T {};"));
    one.write(one.addChannel("t", "cdr", schema, {{"writer", writer}}), 0, 0, 0, {});
    one.close();
    readers.push_back(std::make_unique<Reader>(files.back()));
  }
  Copier copy(folder.file("out"));
  for (const auto& one : readers) {
    copy.channels(*one);
    one->forEachMessage({}, [&](const MessageView& message) { copy.message(message); });
  }
  copy.finish();
  const Reader reader(folder.file("out"));
  EXPECT_EQ(reader.schemas().size(), 3U);
  ASSERT_EQ(reader.channels().size(), 2U);
  EXPECT_EQ(reader.statistics().channel_message_counts,
            (std::map<ChannelId, std::uint64_t>{{ChannelId{1}, 2}, {ChannelId{2}, 1}}));
}

}  // namespace
}  // namespace baton::mcap
