/// A summary held against the data that it is of.
#include <algorithm>
#include <set>
#include <tuple>

#include "base/plural.hpp"
#include "mcap/contents.hpp"
#include "mcap/index.hpp"
#include "mcap/shape.hpp"

namespace baton::mcap {
namespace {

std::string range(std::uint64_t start, std::uint64_t end) {
  return std::to_string(start) + " to " + std::to_string(end);
}

template <class Id, class Declared>
std::string undeclaredOrOther(const char* kind, const std::map<Id, Declared>& listed,
                              const std::map<Id, Declared>& found) {
  for (const auto& [id, one] : found) {
    const auto same = listed.find(id);
    const std::string name = std::string(kind) + " " + std::to_string(static_cast<unsigned>(id));
    if (same == listed.end()) return "it does not list " + name;
    if (same->second != one) return name + " is another in the data";
  }
  return "";
}

/// Both are in the order of the file; one whose chunk is damaged, or has no messages, was not found.
std::string otherExtent(const FileIndex& summary, const FileIndex& found) {
  auto real = found.extents.begin();
  for (const Extent& listed : summary.extents) {
    while (real != found.extents.end() && real->offset < listed.offset) ++real;
    if (real == found.extents.end() || real->offset != listed.offset) continue;
    if (listed.start_time_ns != real->start_time_ns || listed.end_time_ns != real->end_time_ns) {
      return "it gives the messages in the " + placeOf(listed) + " the times " +
             range(listed.start_time_ns, listed.end_time_ns) + " ns, they have " +
             range(real->start_time_ns, real->end_time_ns);
    }
    const std::set<ChannelId> channels(listed.channels.begin(), listed.channels.end());
    for (const ChannelId id : real->channels) {
      if (channels.empty() || channels.contains(id)) continue;
      return "it does not say that the " + placeOf(listed) + " has messages of channel " +
             std::to_string(static_cast<unsigned>(id));
    }
  }
  return "";
}

std::string otherCounts(const Statistics& summary, const Statistics& found) {
  if (summary.message_count != found.message_count) {
    return "it counts " + counted(summary.message_count, "message") + " where there are " +
           std::to_string(found.message_count);
  }
  for (const auto& [id, count] : found.channel_message_counts) {
    const auto listed = summary.channel_message_counts.find(id);
    const std::uint64_t claimed = listed == summary.channel_message_counts.end() ? 0 : listed->second;
    if (claimed == count) continue;
    return "it counts " + counted(claimed, "message") + " of channel " + std::to_string(static_cast<unsigned>(id)) +
           ", there are " + std::to_string(count);
  }
  if (summary.start_time_ns != found.start_time_ns || summary.end_time_ns != found.end_time_ns) {
    return "it has messages from " + range(summary.start_time_ns, summary.end_time_ns) + " ns, they are from " +
           range(found.start_time_ns, found.end_time_ns);
  }
  return "";
}

/// Of indexes of attachments or of metadata records: `same` compares what they say. Their places are right by now.
template <class Index, class Same>
std::string otherRecord(const std::vector<Index>& summary, const std::vector<Index>& found, const char* kind,
                        const Same& same) {
  for (const Index& real : found) {
    const auto listed = std::ranges::find(summary, real.offset, &Index::offset);
    if (listed == summary.end() || same(*listed, real)) continue;
    return std::string("it describes another ") + kind + " than the one at byte " + std::to_string(real.offset) +
           ", which is called \"" + real.name + "\"";
  }
  return "";
}

bool isSame(const AttachmentIndex& a, const AttachmentIndex& b) {
  const auto fields = [](const AttachmentIndex& one) {
    return std::tie(one.length, one.log_time_ns, one.create_time_ns, one.data_size, one.name, one.media_type);
  };
  return fields(a) == fields(b);
}

/// What a chunk's head says: "lz4, 100 bytes of 200".
std::string packingOf(const std::string& compression, std::uint64_t packed_size, std::uint64_t plain_size) {
  return (compression.empty() ? "not compressed" : compression) + ", " + std::to_string(packed_size) + " bytes of " +
         std::to_string(plain_size);
}

}  // namespace

std::string problemOf(const InputFile& file, const ChunkIndex& index) {
  const std::string begin = "its summary's index of the chunk at byte " + std::to_string(index.chunk_offset);
  const std::uint64_t body = index.chunk_offset + kRecordHeadBytes, name_at = body + 8 + 8 + 8 + 4 + 4;
  std::string name(static_cast<std::size_t>(std::min<std::uint64_t>(numberAt<std::uint32_t>(file, name_at - 4), 64)),
                   '\0');
  if (name.size() <= file.size() - std::min(file.size(), name_at)) {
    file.read(name_at, std::as_writable_bytes(std::span(name)));
  }
  const std::string packing = packingOf(index.compression, index.packed_size, index.plain_size);
  const std::string found =
      packingOf(name, numberAt<std::uint64_t>(file, name_at + name.size()), numberAt<std::uint64_t>(file, body + 16));
  if (packing != found) return begin + " says " + packing + ", the chunk says " + found;

  const std::uint64_t indexes_at = index.chunk_offset + index.chunk_length;
  RecordWalk walk(file, indexes_at, file.size());
  std::map<std::uint64_t, ChannelId> there;  // by place
  while (walk.position() < indexes_at + index.message_index_length) {
    const std::optional<RecordPlace> place = walk.next();
    if (!place || place->opcode != Opcode::kMessageIndex) break;
    there[place->offset] =
        ChannelId{static_cast<std::uint16_t>(numberAt<std::uint16_t>(file, place->offset + kRecordHeadBytes))};
  }
  for (const auto& [id, offset] : index.message_index_offsets) {
    const auto one = there.find(offset);
    if (one != there.end() && one->second == id) continue;
    return begin + " gives byte " + std::to_string(offset) + " for the messages of channel " +
           std::to_string(static_cast<unsigned>(id)) + ", where their index is not";
  }
  const std::optional<RecordPlace> next = walk.peek();
  if (walk.position() == indexes_at + index.message_index_length && (!next || next->opcode != Opcode::kMessageIndex))
    return "";
  return begin + " says that its messages are indexed in " + std::to_string(index.message_index_length) +
         " bytes after it, which is not where their indexes end";
}

std::string contradictionOf(const FileIndex& summary, const FileIndex& found, bool is_damaged) {
  if (!found.info.contradictions.empty()) return "its summary is not used, as its data contradict it or themselves";
  const std::string begin = "its summary contradicts its data: ";
  for (const std::string& text :
       {undeclaredOrOther("schema", summary.schemas, found.schemas),
        undeclaredOrOther("channel", summary.channels, found.channels), otherExtent(summary, found),
        is_damaged ? std::string() : otherCounts(summary.statistics, found.statistics),
        otherRecord(summary.attachments, found.attachments, "attachment", isSame),
        otherRecord(summary.metadata, found.metadata, "metadata record",
                    [](const auto&a, const auto&b) { return a.name == b.name; })}) {
    if (!text.empty()) return begin + text;
  }
  return "";
}

}  // namespace baton::mcap
