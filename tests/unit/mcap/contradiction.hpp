/// A file of two chunks that tests make contradict itself, and what a reader says of it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "indexed_file.hpp"
#include "mcap/copy.hpp"

namespace baton::mcap {

inline const Schema kSchema{.id = SchemaId{1}, .name = "T", .encoding = "omgidl", .data = {}};

inline Channel channelOf(std::uint16_t id, const std::string& topic, std::uint16_t schema = 1) {
  return {.id = ChannelId{id}, .schema_id = SchemaId{schema}, .topic = topic, .message_encoding = "cdr"};
}

/// Two chunks with five messages each of two topics, an attachment and a metadata record.
inline void fill(IndexedFile& file) {
  for (std::uint64_t chunk = 0; chunk < 2; ++chunk) {
    file.schema(kSchema);
    file.channel(channelOf(1, "a"));
    file.channel(channelOf(2, "b"));
    for (std::uint64_t i = 0; i < 5; ++i) file.message(i == 2 ? 2 : 1, 1000 + 100 * chunk + i);
    file.closeChunk();
  }
  file.attachment("notes.txt", "hello");
  file.addMetadata("run");
}

inline bool mentions(const FileInfo& info, const std::string& words) {
  const auto has = [&](const std::string& text) { return text.find(words) != std::string::npos; };
  return has(info.problem) || std::ranges::any_of(info.contradictions, has);
}

inline std::string textOf(const FileInfo& info) {
  std::string text = info.problem;
  for (const std::string& one : info.contradictions) text += "\n" + one;
  return text;
}

class ContradictionTest : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> topicsOf(const Reader& reader) const {
    std::vector<std::string> topics;
    for (const Sample& sample : samplesOf(reader, {.order = MessageFilter::Order::kFile}))
      topics.push_back(sample.topic);
    return topics;
  }
  Recovery recovered() const {
    RecoverOptions options;
    options.writer.sync_on_close = false;
    options.writer.if_exists = OutputFile::IfExists::kReplace;
    options.lossy_name = [](const std::string& name) { return "original " + name; };
    return recover(path, out, options);
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder.file("run.mcap");
  std::filesystem::path out = folder.file("out.mcap");
};

}  // namespace baton::mcap
