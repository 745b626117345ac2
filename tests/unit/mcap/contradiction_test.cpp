/// Files that contradict themselves: an index of other data than there are, an id with two meanings. The data count,
/// and the contradiction is named.
#include "contradiction.hpp"

namespace baton::mcap {
namespace {

TEST_F(ContradictionTest, AnIndexThatAgreesWithItsDataIsUsed) {
  IndexedFile file;
  fill(file);
  saveFile(path, file.finished());
  const Reader reader(path);
  EXPECT_TRUE(reader.info().has_summary) << textOf(reader.info());
  EXPECT_EQ(textOf(reader.info()), "");
  EXPECT_EQ(samplesOf(reader).size(), 10U);
  EXPECT_TRUE(recovered().is_whole);
}

TEST_F(ContradictionTest, AnIndexThatContradictsItsDataIsNotBelieved) {
  struct Case {
    const char* words;
    std::function<void(IndexedFile&)> summary;
    std::function<void(Chunk&)> head = [](Chunk&) {};
    std::function<bool(MessageIndex&)> messages = [](MessageIndex&) { return true; };
  };
  const auto nothing = [](IndexedFile&) {};
  const auto isOfB = [](const MessageIndex& index) { return index.channel_id == ChannelId{2}; };
  const std::vector<Case> cases{
      {"the times 0 to 0 ns", [](IndexedFile& f) { f.chunks[0].start_time_ns = f.chunks[0].end_time_ns = 0; }},
      {"the times 5000 to 6000",
       [](IndexedFile& f) { f.chunks[1].start_time_ns = 5000, f.chunks[1].end_time_ns = 6000; }},
      {"the times 1001 to 1004", [](IndexedFile& f) { f.chunks[0].start_time_ns = 1001; }},
      {"has messages of channel 2", [](IndexedFile& f) { f.chunks[1].message_index_offsets.pop_back(); }},
      {"messages from 0 to 1104 ns", [](IndexedFile& f) { f.statistics.start_time_ns = 0; }},
      {"messages from 1000 to 9999 ns", [](IndexedFile& f) { f.statistics.end_time_ns = 9999; }},
      {"it counts 11 messages",
       [](IndexedFile& f) { ++f.statistics.message_count, ++f.statistics.channel_message_counts[ChannelId{2}]; }},
      {"it counts 9 messages of channel 1",
       [](IndexedFile& f) {
         ++f.statistics.channel_message_counts[ChannelId{1}], --f.statistics.channel_message_counts[ChannelId{2}];
       }},
      {"channel 1 is another in the data", [](IndexedFile& f) { f.channels[0].topic = "other"; }},
      {"schema 1 is another in the data", [](IndexedFile& f) { f.schemas[0].data = payload(3, 1); }},
      {"describes another attachment", [](IndexedFile& f) { f.attachments[0].name = "other"; }},
      {"describes another attachment", [](IndexedFile& f) { f.attachments[0].data_size = std::uint64_t{1} << 60; }},
      {"describes another metadata record", [](IndexedFile& f) { f.metadata[0].name = "other"; }},
      {"lists a record Attachment of 77 bytes", [](IndexedFile& f) { f.attachments[0].length = 77; }},
      {"where none begins", [](IndexedFile& f) { f.attachments[0].offset += 3; }},
      {"where none begins", [](IndexedFile& f) { f.metadata[0].offset = std::uint64_t{1} << 60; }},
      {"lists a record Chunk", [](IndexedFile& f) { f.chunks[0].chunk_length += 1; }},
      {"gives its messages the times 0 to 0", nothing, [](Chunk& head) { head.start_time_ns = head.end_time_ns = 0; }},
      {"is not that of the messages of channel 2", nothing, [](Chunk&) {},
       [&](MessageIndex& index) { return isOfB(index) ? (index.entries[0].offset += 1, true) : true; }},
      {"is not that of the messages of channel 2", nothing, [](Chunk&) {},
       [&](MessageIndex& index) { return isOfB(index) ? (index.entries[0].log_time_ns = 0, true) : true; }},
      {"leave out channel 2", nothing, [](Chunk&) {}, [&](MessageIndex& index) { return !isOfB(index); }},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.words);
    IndexedFile file;
    file.change_head = one.head;
    file.change_message_index = one.messages;
    file.change_summary = one.summary;
    fill(file);
    saveFile(path, file.finished());
    const Reader reader(path);
    EXPECT_FALSE(reader.info().has_summary);
    EXPECT_TRUE(reader.info().is_complete);
    EXPECT_TRUE(mentions(reader.info(), one.words)) << textOf(reader.info());
    EXPECT_NE(reader.info().problem, "");
    EXPECT_EQ(logTimesOf(reader),
              (std::vector<std::uint64_t>{1000, 1001, 1002, 1003, 1004, 1100, 1101, 1102, 1103, 1104}));
    EXPECT_EQ(logTimesOf(reader, {.start_time_ns = 1104}), std::vector<std::uint64_t>{1104});
    EXPECT_EQ(logTimesOf(reader, {.topics = {"b"}}), (std::vector<std::uint64_t>{1002, 1102}));
    EXPECT_EQ(reader.statistics().start_time_ns, 1000U);
    EXPECT_EQ(reader.statistics().end_time_ns, 1104U);
    EXPECT_EQ(reader.attachments().at(0).name, "notes.txt");
    EXPECT_EQ(reader.readAttachment(reader.attachments().at(0)).size(), 5U);
    EXPECT_EQ(reader.metadata().at(0).name, "run");
    const Recovery found = recovered();
    EXPECT_TRUE(found.lost.empty());
    EXPECT_FALSE(found.is_whole);
    EXPECT_EQ(found.messages, 10U);
    EXPECT_EQ(textOf(Reader(out).info()), "");
  }
}

TEST_F(ContradictionTest, AnIndexThatPointsNowhereIsNamed) {
  const auto nothing = [](IndexedFile&) {};
  struct Case {
    const char* words;
    std::function<void(IndexedFile&)> summary;
    std::function<void(SummaryOffset&, Footer&)> offsets = [](SummaryOffset&, Footer&) {};
  };
  const std::vector<Case> cases{
      {"for the messages of channel 2", [](IndexedFile& f) { f.chunks[1].message_index_offsets[1].second += 9; }},
      {"for the messages of channel 1", [](IndexedFile& f) { f.chunks[0].message_index_offsets[0].second = ~0ULL; }},
      {"for the messages of channel 2",
       [](IndexedFile& f) {
         f.chunks[0].message_index_offsets[1].second = f.chunks[0].message_index_offsets[0].second;
       }},
      {"does not fit its data", [](IndexedFile& f) { f.chunks[1].message_index_length -= 1; }},
      {"for the messages of channel 1", [](IndexedFile& f) { f.chunks[0].message_index_length = 0; }},
      {"not where their indexes end",
       [](IndexedFile& f) {
         f.chunks[0].message_index_offsets.clear();
         f.chunks[0].message_index_length = 0;
       }},
      {"says lz4", [](IndexedFile& f) { f.chunks[0].compression = "lz4"; }},
      {"the chunk says not compressed", [](IndexedFile& f) { f.chunks[1].plain_size += 1; }},
      {"the chunk says not compressed", [](IndexedFile& f) { f.chunks[1].packed_size += 1; }},
      {"does not list every schema", [](IndexedFile& f) { f.statistics.schema_count = 9; }},
      {"records Statistics, which are not those", nothing, [](SummaryOffset& one, Footer&) { one.group_length += 1; }},
      {"records Statistics, which are not those", nothing, [](SummaryOffset& one, Footer&) { one.group_start = 0; }},
      {"records Schema, which are not those", nothing,
       [](SummaryOffset& one, Footer&) { one.group = Opcode::kSchema; }},
      {"for the offsets in its summary", nothing, [](SummaryOffset&, Footer& one) { one.summary_offset_start += 1; }},
      {"gives no summary, though", nothing, [](SummaryOffset&, Footer& one) { one = {}; }},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.words);
    IndexedFile file;
    file.change_summary = one.summary;
    file.change_offsets = one.offsets;
    fill(file);
    saveFile(path, file.finished());
    const Reader reader(path);
    EXPECT_FALSE(reader.info().has_summary);
    EXPECT_TRUE(reader.info().is_complete);
    EXPECT_TRUE(mentions(reader.info(), one.words)) << textOf(reader.info());
    EXPECT_EQ(samplesOf(reader).size(), 10U);
    const Recovery found = recovered();
    EXPECT_TRUE(found.lost.empty());
    EXPECT_FALSE(found.is_whole);
    EXPECT_EQ(found.messages, 10U);
    EXPECT_EQ(textOf(Reader(out).info()), "");
  }
}

TEST_F(ContradictionTest, OfAnIdWithTwoMeaningsTheLaterCountsFromThereOn) {
  for (const bool is_cut : {false, true}) {
    IndexedFile file;
    file.schema(kSchema);
    file.channel(channelOf(1, "a"));
    file.message(1, 1);
    file.closeChunk();
    file.message(1, 2);
    file.channel(channelOf(1, "other"));  // within a chunk
    file.message(1, 3);
    file.closeChunk();
    file.channel(channelOf(65535, "b"));
    file.message(1, 4);
    file.message(65535, 5);
    file.channel(channelOf(1, "a"));  // and back
    file.message(1, 6);
    file.closeChunk();
    saveFile(path, is_cut ? file.cut() : file.finished());
    const Reader reader(path);
    EXPECT_EQ(topicsOf(reader), (std::vector<std::string>{"a", "a", "other", "other", "b", "a"}));
    EXPECT_EQ(logTimesOf(reader, {.topics = {"other"}}), (std::vector<std::uint64_t>{3, 4}));
    EXPECT_TRUE(mentions(reader.info(), "channel 1 is declared again")) << textOf(reader.info());
    EXPECT_TRUE(mentions(reader.info(), "a before, other from there on")) << textOf(reader.info());
    EXPECT_EQ(reader.channels().size(), 3U);
    const Recovery found = recovered();
    EXPECT_EQ(found.lost.empty(), !is_cut);
    EXPECT_TRUE(mentions(found.info, "channel 1 is declared again"));
    const Reader copy(out);
    EXPECT_EQ(topicsOf(copy), topicsOf(reader));
    EXPECT_EQ(textOf(copy.info()), "");
  }
}

TEST_F(ContradictionTest, ASchemaWithTwoMeaningsIsThatOfItsChannelsFromThereOn) {
  Schema other = kSchema;
  other.name = "Other";
  IndexedFile file;
  file.schema(kSchema);
  file.channel(channelOf(1, "a"));
  file.message(1, 1);
  file.closeChunk();
  file.schema(other);
  file.message(1, 2);
  file.closeChunk();
  saveFile(path, file.cut());
  const Reader reader(path);
  std::vector<std::string> names;
  reader.forEachMessage({}, [&](const MessageView& message) { names.push_back(message.schema->name); });
  EXPECT_EQ(names, (std::vector<std::string>{"T", "Other"}));
  EXPECT_TRUE(mentions(reader.info(), "schema 1 is declared again")) << textOf(reader.info());
}

TEST_F(ContradictionTest, MoreMeaningsThanIdsAreRefused) {
  IndexedFile file;
  for (unsigned i = 0; i < 70'000; ++i) file.channel(channelOf(1, std::to_string(i), 0));
  file.message(1, 1);
  file.closeChunk();
  saveFile(path, file.cut());
  EXPECT_THROW(Reader{path}, FormatError);
  EXPECT_LT(recovered().info.contradictions.size(), 30U) << "a few are enough to know";
}

TEST_F(ContradictionTest, ADamagedMessageIndexIsNamedThoughTheSummaryAgrees) {
  IndexedFile file;
  file.channel(channelOf(1, "a", 0));
  for (std::uint64_t chunk = 0; chunk < 2; ++chunk) {
    for (std::uint64_t i = 0; i < 3; ++i) file.message(1, 10 * chunk + i);
    file.closeChunk();
  }
  const Bytes sound = file.finished();
  for (const ChunkIndex& chunk : file.chunks) {
    Bytes bytes = sound;
    const std::size_t index = chunk.chunk_offset + chunk.chunk_length;
    bytes[index + kRecordHeadBytes + 2] = std::byte{15};  // of 48 bytes of entries
    saveFile(path, bytes);
    std::vector<Damage> damage;
    ReaderOptions options;
    options.on_damage = [&](const Damage& found) { damage.push_back(found); };
    EXPECT_EQ(samplesOf(Reader(path, options)).size(), 6U);
    ASSERT_EQ(damage.size(), 1U);
    EXPECT_EQ(damage[0].offset, index);
    const Recovery found = recovered();
    EXPECT_EQ(found.messages, 6U);
    EXPECT_EQ(found.lost.size(), 1U);
    EXPECT_FALSE(found.is_whole);
  }
}

TEST_F(ContradictionTest, AChannelWhoseSchemaIsDeclaredNowhereIsNamed) {
  for (const bool is_cut : {true, false}) {
    IndexedFile file;
    file.channel(channelOf(1, "a", 7));
    file.channel(channelOf(2, "b", 0));
    file.message(1, 1);
    file.message(2, 2);
    file.closeChunk();
    saveFile(path, is_cut ? file.cut() : file.finished());
    EXPECT_EQ(Reader(path).info().contradictions,
              (std::vector<std::string>{"channel 1 (a) has schema 7, which is declared nowhere: its messages stay "
                                        "bytes"}));
    EXPECT_EQ(recovered().messages, 2U);
  }
}

TEST_F(ContradictionTest, ASchemaThatOnlyTheSummaryDeclaresIsUsed) {
  IndexedFile file;
  file.channel(channelOf(1, "a"));
  file.message(1, 1);
  file.closeChunk();
  for (const bool is_right : {true, false}) {
    file.change_summary = [&](IndexedFile& f) {
      f.schemas = {kSchema};
      f.statistics.schema_count = 1;
      if (!is_right) f.statistics.message_count = 7;
    };
    saveFile(path, file.finished());
    const Reader reader(path);
    EXPECT_EQ(reader.schemas().size(), 1U);
    EXPECT_EQ(reader.info().has_summary, is_right) << textOf(reader.info());
    EXPECT_TRUE(reader.info().contradictions.empty()) << textOf(reader.info());
  }
}

TEST_F(ContradictionTest, DataAfterTheEndOfTheDataAreNotSilentlyLost) {
  IndexedFile file;
  fill(file);
  Bytes bytes = file.cut();
  appendDataEnd(bytes, {});
  FileBuilder chunk;
  Bytes records;
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 7});
  chunk.chunk(records, 7, 7);
  append(bytes, ByteView(chunk.bytes).subspan(rawRecords(file.cut()).front().end()));
  appendFooter(bytes, {});
  append(bytes, kMagic);
  saveFile(path, bytes);
  EXPECT_THROW(Reader{path}, FormatError);
  const Recovery found = recovered();
  EXPECT_EQ(found.messages, 10U);
  EXPECT_EQ(found.lost.size(), 1U);
}

/// The specification lets records grow at their end.
class LongerRecordTest : public ContradictionTest, public testing::WithParamInterface<Bytes> {};
INSTANTIATE_TEST_SUITE_P(Extras, LongerRecordTest,
                         testing::Values(Bytes{std::byte{1}, std::byte{0xFF}, std::byte{0xFF}}, Bytes(16, std::byte{0}),
                                         Bytes(300, std::byte{6})));

TEST_P(LongerRecordTest, BytesAfterTheKnownFieldsAreIgnored) {
  IndexedFile file(GetParam());
  fill(file);
  const Bytes bytes = file.finished();
  saveFile(path, bytes);
  EXPECT_TRUE(Reader(path).info().has_summary) << textOf(Reader(path).info());
  EXPECT_TRUE(recovered().is_whole);
  // Without its index, and without the end of it: by its data alone.
  for (const std::size_t size : {file.cut().size(), bytes.size() - 10}) {
    saveFile(path, ByteView(bytes).first(size));
    for (const bool is_tolerant : {false, true}) {
      std::vector<Damage> damage;
      ReaderOptions options;
      if (is_tolerant) options.on_damage = [&](const Damage& one) { damage.push_back(one); };
      const Reader reader(path, options);
      EXPECT_EQ(samplesOf(reader).size(), 10U);
      EXPECT_TRUE(damage.empty()) << describe(damage.at(0));
      EXPECT_TRUE(reader.info().contradictions.empty()) << textOf(reader.info());
      ASSERT_EQ(reader.attachments().size(), 1U);
      EXPECT_EQ(reader.readAttachment(reader.attachments()[0]).size(), 5U);
      EXPECT_EQ(reader.metadata().size(), 1U);
      EXPECT_EQ(reader.info().has_all_data, size > file.cut().size());
    }
  }
}

}  // namespace
}  // namespace baton::mcap
