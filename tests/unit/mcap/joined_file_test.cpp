/// Recordings that were joined end to end in one file, some of them cut.
#include "contradiction.hpp"

namespace baton::mcap {
namespace {

class JoinedFileTest : public ContradictionTest {};

TEST_F(JoinedFileTest, RecordingsThatWereJoinedAreAllRead) {
  IndexedFile first, second;
  fill(first);
  second.channel(channelOf(1, "another topic", 0));
  second.channel(channelOf(2, "b", 0));
  second.message(1, 5);
  second.message(2, 6);
  second.closeChunk();
  const Bytes one = first.finished(), two = second.finished();
  Bytes file = one;
  append(file, two);
  append(file, one);
  saveFile(path, file);
  const Reader reader(path);
  EXPECT_TRUE(reader.info().is_complete) << textOf(reader.info());
  EXPECT_TRUE(mentions(reader.info(), "another recording begins at byte " + std::to_string(one.size())));
  EXPECT_TRUE(mentions(reader.info(), "another recording begins at byte " + std::to_string(one.size() + two.size())));
  EXPECT_EQ(samplesOf(reader).size(), 22U);
  EXPECT_EQ(samplesOf(reader, {.topics = {"another topic"}}).size(), 1U);
  EXPECT_EQ(reader.attachments().size(), 2U);
  const Recovery found = recovered();
  EXPECT_EQ(found.messages, 22U);
  EXPECT_TRUE(found.lost.empty());
  EXPECT_FALSE(found.is_whole);
  EXPECT_EQ(Reader(out).metadata().at(0).name, "original run") << "what was said of one of them";
}

TEST_F(JoinedFileTest, ChecksTheDataOfEachRecordingThatWasJoined) {
  const auto write = [&] {
    std::filesystem::remove(path);
    Writer writer(path);
    writer.write(writer.addChannel("a", "cdr", kNoSchema), 0, 1, 1, payload(100, 1));
    writer.close();
    return loadFile(path);
  };
  const Bytes one = write();
  Bytes file = one;
  append(file, one);
  saveFile(path, file);
  EXPECT_EQ(Reader(path).dataCrcMatches(), true);
  file[one.size() + 26] ^= std::byte{1};  // in the name of the library that wrote it
  saveFile(path, file);
  EXPECT_EQ(Reader(path).dataCrcMatches(), false);
}

TEST_F(JoinedFileTest, ARecordingWithoutAnEndBeforeAnotherOneIsACut) {
  IndexedFile first, second;
  fill(first);
  fill(second);
  Bytes file = first.cut();
  append(file, second.finished());
  saveFile(path, file);
  const Reader reader(path);
  EXPECT_FALSE(reader.info().is_complete);
  EXPECT_TRUE(mentions(reader.info(), "is cut: it has no end")) << textOf(reader.info());
  EXPECT_EQ(samplesOf(reader).size(), 20U);
  EXPECT_EQ(reader.info().complete_bytes, first.cut().size());
  const Recovery found = recovered();
  ASSERT_EQ(found.lost.size(), 1U);
  EXPECT_EQ(found.lost[0].offset, first.cut().size()) << "where it was cut, not where the file ends";
  EXPECT_EQ(found.lost[0].length, 0U);
  EXPECT_NE(describe(found.lost[0]).find("something is missing at byte"), std::string::npos);
}

TEST_F(JoinedFileTest, RecordingsThatAreCutOneAfterAnotherAreLossesEach) {
  IndexedFile file;
  fill(file);
  const std::size_t size = file.cut().size();
  Bytes bytes = file.cut();
  append(bytes, file.cut());
  append(bytes, ByteView(file.finished()).first(size - 1));
  saveFile(path, bytes);
  const Recovery found = recovered();
  ASSERT_EQ(found.lost.size(), 3U);
  EXPECT_EQ(found.lost[0].offset, size);
  EXPECT_EQ(found.lost[1].offset, 2 * size);
  EXPECT_EQ(found.lost[2].offset + found.lost[2].length, 3 * size - 1);
  EXPECT_EQ(found.lost[0].length + found.lost[1].length, 0U);
  EXPECT_GT(found.lost[2].length, 0U);
}

TEST_F(JoinedFileTest, ARecordingThatIsCutAnywhereDoesNotMixWithTheNext) {
  IndexedFile first, second;
  fill(first);
  second.channel(channelOf(1, "next", 0));  // in its first chunk only
  for (std::uint64_t chunk = 0; chunk < 20; ++chunk) {
    for (std::uint64_t i = 0; i < 8; ++i) second.message(1, 5000 + 8 * chunk + i);
    second.closeChunk();
  }
  const Bytes one = first.finished(), two = second.finished();
  for (std::size_t size = first.chunks[0].chunk_offset; size < one.size(); ++size) {
    SCOPED_TRACE("cut after " + std::to_string(size) + " of " + std::to_string(one.size()) + " bytes");
    Bytes file(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(size));
    append(file, two);
    saveFile(path, file);
    std::vector<Damage> damage;
    ReaderOptions options;
    options.on_damage = [&](const Damage& found) { damage.push_back(found); };
    const Reader reader(path, options);
    ASSERT_EQ(reader.info().beginnings, (std::vector<std::uint64_t>{0, size})) << textOf(reader.info());
    EXPECT_FALSE(reader.info().is_complete);
    EXPECT_EQ(reader.info().complete_bytes, size);
    EXPECT_EQ(samplesOf(reader, {.topics = {"next"}}).size(), 160U);
    const auto chunks = std::ranges::count_if(
        first.chunks, [&](const ChunkIndex& chunk) { return chunk.chunk_offset + chunk.chunk_length <= size; });
    EXPECT_EQ(samplesOf(reader).size(), 160U + 5U * static_cast<std::size_t>(chunks));
    for (const Damage& lost : damage) EXPECT_LE(lost.offset + lost.length, size) << describe(lost);
  }
}

TEST_F(JoinedFileTest, ADamagedChunkThatHoldsARecordingIsNotCut) {
  IndexedFile inner;
  fill(inner);
  FileBuilder file;
  Bytes records;
  appendChannel(records, channelOf(1, "files", 0));
  appendMessage(records, {.channel_id = ChannelId{1}, .log_time_ns = 1, .data = inner.finished()});
  file.chunk(records, 1, 1);
  file.bytes[file.bytes.size() - 20] ^= std::byte{1};  // in the footer of that recording
  file.finish();
  saveFile(path, file.bytes);
  const Recovery found = recovered();
  EXPECT_EQ(found.messages, 0U);
  EXPECT_EQ(found.lost.size(), 1U);
  EXPECT_EQ(found.info.beginnings.size(), 1U);
}

TEST_F(JoinedFileTest, DamageAtTheEndOfARecordingDoesNotMixItWithTheNext) {
  IndexedFile first, second;
  fill(first);
  second.channel(channelOf(1, "another topic", 0));
  second.message(1, 5);
  second.closeChunk();
  Bytes file = first.finished();
  file[first.chunks[1].chunk_offset + 4] = std::byte{0x7F};  // far beyond the end of the file
  append(file, second.finished());
  saveFile(path, file);
  const Recovery found = recovered();
  EXPECT_FALSE(found.lost.empty());
  EXPECT_EQ(samplesOf(Reader(out), {.topics = {"another topic"}}).size(), 1U);
  EXPECT_EQ(found.messages, 6U);
  EXPECT_TRUE(mentions(found.info, "another recording begins")) << textOf(found.info);
}

TEST_F(JoinedFileTest, BytesAfterTheEndAreNamedAndNoLoss) {
  IndexedFile file;
  fill(file);
  Bytes bytes = file.finished();
  const std::size_t end = bytes.size();
  append(bytes, asBytes("anything"));
  saveFile(path, bytes);
  const Recovery found = recovered();
  EXPECT_EQ(found.messages, 10U);
  EXPECT_TRUE(found.lost.empty());
  ASSERT_EQ(found.info.foreign.size(), 1U);
  EXPECT_EQ(found.info.foreign[0].offset, end);
  EXPECT_EQ(found.info.foreign[0].length, 8U);
  EXPECT_FALSE(found.is_whole);
  EXPECT_EQ(Reader(out).metadata().at(0).name, "run") << "it is all of the one recording";
}

}  // namespace
}  // namespace baton::mcap
