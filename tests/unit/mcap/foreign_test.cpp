/// Bytes that belong to no recording, before, between and behind recordings, and files that are none.
#include <algorithm>

#include "indexed_file.hpp"
#include "mcap/copy.hpp"

namespace baton::mcap {
namespace {

Bytes bytesOf(std::string_view text) {
  const ByteView view = asBytes(text);
  return {view.begin(), view.end()};
}

Bytes joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) append(all, part);
  return all;
}

/// Two chunks with three messages each.
IndexedFile filled(const std::string& topic) {
  IndexedFile file;
  for (std::uint64_t chunk = 0; chunk < 2; ++chunk) {
    file.channel({.id = ChannelId{1}, .schema_id = kNoSchema, .topic = topic, .message_encoding = "cdr"});
    for (std::uint64_t i = 0; i < 3; ++i) file.message(1, 1000 + 100 * chunk + i);
    file.closeChunk();
  }
  return file;
}

class ForeignTest : public testing::Test {
 protected:
  [[nodiscard]] Recovery recovered() const {
    RecoverOptions options;
    options.writer.sync_on_close = false;
    options.writer.if_exists = OutputFile::IfExists::kReplace;
    return recover(path, out, options);
  }
  /// What is said of a file that is refused.
  [[nodiscard]] std::string refusal(ByteView bytes) const {
    saveFile(path, bytes);
    try {
      const Reader reader(path);
    } catch (const FormatError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
  std::filesystem::path out = folder.file("out.mcap");
  const Bytes a = filled("a").finished();
  const Bytes b = filled("b").finished();
};

TEST_F(ForeignTest, RecordingsAreFoundWhereverTheyBegin) {
  for (const Bytes& between : {Bytes(1), Bytes(5000), bytesOf("junk"), payload(5'000'000, 1)}) {
    SCOPED_TRACE(between.size());
    saveFile(path, joined({between, a, between, b, between, a, between}));
    const Reader reader(path);
    EXPECT_EQ(samplesOf(reader).size(), 18U);
    EXPECT_EQ(samplesOf(reader, {.topics = {"b"}}).size(), 6U);
    const FileInfo& info = reader.info();
    ASSERT_EQ(info.beginnings.size(), 3U);
    EXPECT_EQ(info.beginnings[1], 2 * between.size() + a.size());
    EXPECT_FALSE(info.is_complete);
    EXPECT_FALSE(info.is_cut) << info.problem;
    ASSERT_EQ(info.foreign.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(info.foreign[i].offset, i * (between.size() + a.size()));
      EXPECT_EQ(info.foreign[i].length, between.size());
    }
    const Recovery found = recovered();
    EXPECT_EQ(found.messages, 18U);
    EXPECT_TRUE(found.lost.empty()) << describe(found.lost.front());
    EXPECT_EQ(found.info.foreign.size(), 4U);
    EXPECT_FALSE(found.is_whole);
    EXPECT_TRUE(Reader(out).info().is_complete);
  }
}

TEST_F(ForeignTest, BytesOfNoRecordingAreNamedAsWhatTheyAre) {
  saveFile(path, joined({a, bytesOf("hello")}));
  EXPECT_EQ(Reader(path).info().problem.find("5 bytes follow the end of the recording at byte " +
                                             std::to_string(a.size()) + " and belong to none"),
            0U)
      << Reader(path).info().problem;
  saveFile(path, joined({a, Bytes(512), b}));
  EXPECT_EQ(Reader(path).info().problem.find("512 zero bytes follow the end"), 0U) << Reader(path).info().problem;
  saveFile(path, joined({bytesOf("\n"), a}));
  const Reader reader(path);
  EXPECT_EQ(reader.info().problem.find("1 byte comes before the recording at byte 1 and belongs to none"), 0U)
      << reader.info().problem;
  EXPECT_TRUE(reader.info().contradictions.empty()) << reader.info().contradictions.front();
}

TEST_F(ForeignTest, TheDataOfARecordingBehindOthersAreChecked) {
  const auto write = [&](const std::string& name) {
    Writer writer(folder.file(name));
    writer.write(writer.addChannel("a", "cdr", kNoSchema), 1, 1, 1, payload(10, 1));
    writer.close();
    return loadFile(folder.file(name));
  };
  const Bytes one = write("one");
  Bytes file = joined({bytesOf("x"), one, Bytes(100), one, bytesOf("x")});
  saveFile(path, file);
  EXPECT_EQ(Reader(path).dataCrcMatches(), true);
  file[1 + one.size() + 100 + 26] ^= std::byte{1};  // in the name of the library that wrote it
  saveFile(path, file);
  EXPECT_EQ(Reader(path).dataCrcMatches(), false);
}

TEST_F(ForeignTest, ACutRecordingBeforeZerosDoesNotHideTheNext) {
  const Bytes cut = filled("a").cut();
  for (const std::vector<Bytes>& parts :
       {std::vector<Bytes>{cut, Bytes(4096), b}, {cut, Bytes(4096), b, b}, {cut, Bytes(4096), b, Bytes(50), b}}) {
    SCOPED_TRACE(parts.size());
    saveFile(path, joined(parts));
    const Recovery found = recovered();
    EXPECT_EQ(found.messages, 6 + 6 * static_cast<std::size_t>(std::ranges::count(parts, b)));
    EXPECT_TRUE(found.info.is_cut);
    EXPECT_FALSE(found.lost.empty());
  }
}

TEST_F(ForeignTest, AMagicThatIsFollowedByARecordingHidesNothing) {
  saveFile(path, joined({Bytes(kMagic.begin(), kMagic.end()), a}));
  const Reader reader(path);
  EXPECT_EQ(samplesOf(reader).size(), 6U);
  EXPECT_TRUE(reader.info().is_cut);
}

TEST_F(ForeignTest, ARecordingInsideAnotherOneIsNotTakenForOne) {
  const auto write = [&] {
    Writer writer(folder.file("outer"));
    writer.write(writer.addChannel("files", "mcap", kNoSchema), 1, 1, 1, b);
    writer.addAttachment("b.mcap", "application/mcap", 1, 1, b);
    writer.close();
    return loadFile(folder.file("outer"));
  };
  const Bytes outer = write();
  Bytes damaged = outer;  // in its magic
  damaged[0] ^= std::byte{1};
  for (const Bytes& bytes : {outer, joined({bytesOf("hello"), outer, Bytes(100)}), damaged}) {
    saveFile(path, bytes);
    const Reader reader(path);
    EXPECT_EQ(reader.info().beginnings.size(), 1U) << reader.info().problem;
    ASSERT_EQ(samplesOf(reader).size(), 1U);
    EXPECT_EQ(samplesOf(reader)[0].topic, "files");
    EXPECT_EQ(reader.attachments().size(), 1U);
  }
  const AttachmentIndex attached = Reader(folder.file("outer")).attachments().at(0);
  saveFile(path, ByteView(outer).first(attached.offset + attached.length - 2));
  EXPECT_EQ(Reader(path).info().beginnings.size(), 1U) << "it is cut behind the recording that is attached";
  saveFile(path, damaged);
  EXPECT_NE(Reader(path).info().contradictions.at(0).find("other bytes than the magic"), std::string::npos);
}

TEST_F(ForeignTest, SaysWhatBecameOfAMagicThatIsAnother) {
  const auto replaced = [&](std::size_t bytes, std::string_view by) {
    return joined({bytesOf(by), Bytes(a.begin() + static_cast<std::ptrdiff_t>(bytes), a.end())});
  };
  EXPECT_NE(refusal(replaced(8, "\x89MCAP1\r\n")).find("an MCAP file of version 1, expected version 0"),
            std::string::npos);
  for (const std::string_view by : {"\x89MCAP0\n", "\x89MCAP0\r\r\n", "\xef\xbf\xbdMCAP0\r\n"}) {
    const std::string text = refusal(replaced(8, by));
    EXPECT_NE(text.find("a transfer in text mode: transfer it again, in binary mode"), std::string::npos) << text;
  }
  EXPECT_NE(refusal(bytesOf("MCAP is a format")).find("it is text"), std::string::npos);
}

}  // namespace
}  // namespace baton::mcap
