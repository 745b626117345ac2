#include "mcap/file.hpp"

#include "recording.hpp"
#include "support/file_size_limit.hpp"

namespace baton::mcap {
namespace {

using test::FileSizeLimit;

template <class Call>
std::string messageOf(Call call) {
  try {
    call();
  } catch (const WriteError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no WriteError";
  return {};
}

class FileTest : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path path = folder.file("out");
};

TEST_F(FileTest, AShortWriteIsAnErrorThatNamesFileAndBytes) {
  OutputFile file(path, OutputFile::IfExists::kRefuse);
  file.write(payload(600, 1));
  {
    const FileSizeLimit limit(1000);
    const std::string message = messageOf([&] { file.write(payload(700, 2)); });
    EXPECT_NE(message.find(path.string()), std::string::npos) << message;
    EXPECT_NE(message.find("wrote 400 of 700 bytes at byte 600"), std::string::npos) << message;
  }
  EXPECT_EQ(file.size(), 1000U);
  EXPECT_EQ(std::filesystem::file_size(path), 1000U);
  // There would be room again, but the file is torn.
  EXPECT_THROW(file.write(payload(1, 3)), WriteError);
  EXPECT_THROW(file.sync(), WriteError);
  EXPECT_THROW(file.close(), WriteError);
  EXPECT_EQ(std::filesystem::file_size(path), 1000U);
  file.discard();
  EXPECT_FALSE(std::filesystem::exists(path)) << "also when closing it has failed";
}

TEST_F(FileTest, WhatIsReplacedIsThereUntilItsSuccessorIsWhole) {
  saveFile(path, payload(100, 1));
  const std::filesystem::path part = path.string() + ".part";
  {
    OutputFile file(path, OutputFile::IfExists::kReplace);
    file.write(payload(20, 2));
    file.sync();
    EXPECT_EQ(loadFile(path), payload(100, 1));
    file.close();
  }
  EXPECT_EQ(loadFile(path), payload(20, 2));
  EXPECT_FALSE(std::filesystem::exists(part));
  {
    OutputFile file(path, OutputFile::IfExists::kReplace);
    file.write(payload(30, 3));
  }
  EXPECT_EQ(loadFile(path), payload(20, 2)) << "not closed";
  EXPECT_FALSE(std::filesystem::exists(part));
  {
    const FileSizeLimit limit(1000);
    OutputFile file(path, OutputFile::IfExists::kReplace);
    EXPECT_THROW(file.write(payload(2000, 4)), WriteError);
    EXPECT_THROW(file.close(), WriteError);
  }
  EXPECT_EQ(loadFile(path), payload(20, 2)) << "no room";
  saveFile(part, payload(5, 5));
  try {
    const OutputFile other(path, OutputFile::IfExists::kReplace);
    ADD_FAILURE() << "the draft is somebody else's";
  } catch (const UnavailableError& error) {
    EXPECT_NE(std::string(error.what()).find("a command that was killed has left it; remove it then"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(loadFile(part), payload(5, 5));
  std::filesystem::remove(part);
  EXPECT_FALSE(std::filesystem::exists(part));
}

TEST_F(FileTest, WhatIsUnfinishedGoesWhenTheProgramIsToEnd) {
  const std::filesystem::path kept = folder.file("kept"), replaced = folder.file("replaced");
  saveFile(kept, payload(10, 1));
  saveFile(replaced, payload(20, 1));
  OutputFile fresh(path, OutputFile::IfExists::kRefuse), draft(replaced, OutputFile::IfExists::kReplace);
  fresh.write(payload(30, 1));
  draft.write(payload(30, 1));
  OutputFile finished(folder.file("finished"), OutputFile::IfExists::kRefuse);
  finished.close();
  EXPECT_THROW(OutputFile(kept, OutputFile::IfExists::kRefuse), UnavailableError);
  OutputFile::removeUnfinished();
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(std::filesystem::exists(replaced.string() + ".part"));
  EXPECT_EQ(std::filesystem::file_size(replaced), 20U);
  EXPECT_TRUE(std::filesystem::exists(folder.file("finished")));
  EXPECT_TRUE(std::filesystem::exists(kept));
}

TEST_F(FileTest, WhatIsDiscardedIsGone) {
  OutputFile file(path, OutputFile::IfExists::kRefuse);
  file.write(payload(10, 1));
  file.discard();
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THROW(file.write(payload(10, 1)), WriteError);
}

TEST_F(FileTest, AnOpenFileOrALinkToOneIsWrittenInPlaceAndStays) {
  saveFile(path, payload(100, 1));
  const std::filesystem::path link = folder.file("link");
  std::filesystem::create_symlink(path, link);
  {
    OutputFile file(link, OutputFile::IfExists::kReplace);
    file.write(payload(20, 2));
    file.discard();
  }
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(loadFile(path), payload(20, 2));
  OutputFile file("/dev/null", OutputFile::IfExists::kReplace);
  file.discard();
  EXPECT_TRUE(std::filesystem::exists("/dev/null"));
}

TEST_F(FileTest, AFullDiskIsReportedAtOnce) {
  OutputFile file("/dev/full", OutputFile::IfExists::kReplace);
  const std::string message = messageOf([&] { file.write(payload(10, 1)); });
  EXPECT_NE(message.find("/dev/full: wrote 0 of 10 bytes at byte 0"), std::string::npos) << message;
  EXPECT_EQ(file.durableSize(), 0U);
}

TEST_F(FileTest, AFailedSyncMakesNothingDurable) {
  OutputFile file("/dev/null", OutputFile::IfExists::kReplace);  // takes everything, keeps nothing
  file.write(payload(10, 1));
  EXPECT_THROW(file.sync(), WriteError);
  EXPECT_EQ(file.durableSize(), 0U);
  EXPECT_THROW(file.write(payload(10, 1)), WriteError);
}

TEST_F(FileTest, CannotBeCreatedWithoutAFolder) {
  EXPECT_THROW(OutputFile(folder.file("no/such/folder"), OutputFile::IfExists::kRefuse), UnavailableError);
}

TEST_F(FileTest, ARecordingThatFillsTheDiskStaysReadable) {
  WriterOptions options;
  options.compression = Compression::kNone;
  options.chunk_bytes = 1000;
  std::uint64_t taken = 0;
  {
    Writer writer(path, options);
    const ChannelId channel = writer.addChannel("a", "cdr", kNoSchema);
    const FileSizeLimit limit(20'000);
    const std::string message = messageOf([&] {
      for (unsigned i = 0; i < 10'000; ++i) writer.write(channel, i, i, i, payload(50, i));
    });
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_NE(message.find(path.string()), std::string::npos) << message;
    taken = writer.statistics().written_messages;
    EXPECT_LE(taken, writer.statistics().messages);
    EXPECT_EQ(messageOf([&] { writer.addChannel("b", "cdr", kNoSchema); }), message);
    EXPECT_EQ(messageOf([&] { writer.close(); }), message);
  }
  const Reader reader(path);
  EXPECT_FALSE(reader.info().is_complete);
  EXPECT_GT(taken, 100U);
  // A chunk may be in whole and only its index cut.
  const std::vector<Sample> samples = samplesOf(reader);
  EXPECT_GE(samples.size(), taken);
  for (unsigned i = 0; i < samples.size(); ++i) ASSERT_EQ(samples[i].data, payload(50, i));
}

TEST_F(FileTest, ReadingBeyondTheEndIsAnError) {
  saveFile(path, payload(100, 1));
  const InputFile file(path);
  EXPECT_EQ(file.size(), 100U);
  Bytes bytes(60);
  file.read(40, bytes);
  EXPECT_EQ(bytes.back(), payload(100, 1).back());
  EXPECT_THROW(file.read(41, bytes), FormatError);
}

}  // namespace
}  // namespace baton::mcap
