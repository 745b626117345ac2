// What files of other writers have that ours have not, and that is no fault.
#include <filesystem>

#include "indexed_file.hpp"

namespace baton::mcap {
namespace {

/// As the Python writer does for every kind of record that a file may have.
TEST(OtherWriters, ListOffsetsOfRecordsThatAreNotThere) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.file("run.mcap");
  IndexedFile file;
  file.schema({.id = SchemaId{1}, .name = "T", .encoding = "omgidl", .data = {}});
  file.channel({.id = ChannelId{1}, .schema_id = SchemaId{1}, .topic = "a", .message_encoding = "cdr"});
  file.message(1, 1000);
  file.closeChunk();
  file.change_offsets = [](SummaryOffset& one, Footer&) {
    one.group = Opcode::kAttachmentIndex;
    one.group_length = 0;
  };
  saveFile(path, file.finished());
  const Reader reader(path);
  EXPECT_TRUE(reader.info().has_summary) << reader.info().problem;
  EXPECT_EQ(reader.info().problem, "");
  EXPECT_TRUE(reader.info().contradictions.empty());
}

/// The conformance tests of the format have such files.
TEST(OtherWriters, PadAnEmptyHeader) {
  Bytes body(8, std::byte{0});
  EXPECT_EQ(decodeHeader(body).library, "");
  body.push_back(std::byte{1});
  EXPECT_EQ(decodeHeader(body).library, "");
}

}  // namespace
}  // namespace baton::mcap
