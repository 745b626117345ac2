#include "mcap/contents.hpp"

#include <algorithm>
#include <utility>

namespace baton::mcap {
namespace {

template <class Id>
std::string numberOf(Id id) {
  return std::to_string(static_cast<unsigned>(id));
}

class ContentsReader {
 public:
  ContentsReader(Declarations& declarations, Contents& found) : declarations_(declarations), found_(found) {}

  void take(Schema schema) {
    const std::string number = numberOf(schema.id), name = schema.name;
    const std::optional<Schema> before = declarations_.take(std::move(schema));
    if (before) noteRedefined("schema " + number, before->name, name);
  }

  void take(Channel channel) {
    const std::string number = numberOf(channel.id), topic = channel.topic;
    const std::optional<Channel> before = declarations_.take(std::move(channel));
    if (before) noteRedefined("channel " + number, before->topic, topic);
  }

  void take(const Message& message, std::uint64_t at) {
    Id& id = ids_.try_emplace(message.channel_id, Id{.told = message.channel_id}).first->second;
    id.entries.push_back({.log_time_ns = message.log_time_ns, .offset = at});
    const std::optional<ChannelId> means = declarations_.meaningOf(message.channel_id);
    if (means != id.told) found_.extent.meanings.push_back({.from = at, .id = message.channel_id, .means = means});
    id.told = means;
    (means ? counted_[*means] : id.undeclared).add(message.log_time_ns);
  }

  void finish() {
    for (auto& [file_id, id] : ids_) {
      found_.entries[file_id] = std::move(id.entries);
      if (id.undeclared.count == 0) continue;
      if (const std::optional<ChannelId> means = declarations_.meaningOf(file_id)) {
        counted_[*means].add(id.undeclared);
      } else {
        found_.undeclared[file_id] = id.undeclared.count;
      }
    }
    for (Extent::Meaning& meaning : found_.extent.meanings) {
      if (!meaning.means) meaning.means = declarations_.meaningOf(meaning.id);
    }
    Messages all;
    for (const auto& [id, messages] : counted_) {
      found_.counts[id] = messages.count;
      found_.extent.channels.push_back(id);
      all.add(messages);
    }
    found_.extent.start_time_ns = all.first_ns;
    found_.extent.end_time_ns = all.last_ns;
  }

 private:
  struct Messages {
    std::uint64_t count = 0;
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    void add(std::uint64_t time_ns) { add({1, time_ns, time_ns}); }
    void add(const Messages& other) {
      if (other.count == 0) return;
      first_ns = count == 0 ? other.first_ns : std::min(first_ns, other.first_ns);
      last_ns = std::max(last_ns, other.last_ns);
      count += other.count;
    }
  };
  struct Id {
    std::optional<ChannelId> told{};  // what a reader of the extent takes it for by now
    Messages undeclared{};
    std::vector<MessageIndex::Entry> entries{};
  };

  void noteRedefined(const std::string& what, const std::string& before, const std::string& now) {
    const std::string names = before == now ? before + ", and differs" : before + " before, " + now + " from there on";
    found_.contradictions.push_back(what + " is declared again in the " + placeOf(found_.extent) + ": " + names);
  }

  Declarations& declarations_;
  Contents& found_;
  std::map<ChannelId, Id> ids_;            // as in the file
  std::map<ChannelId, Messages> counted_;  // by the id in the index
};

}  // namespace

std::string placeOf(const Extent& extent) {
  return (extent.is_chunk ? "chunk at byte " : "records at byte ") + std::to_string(extent.offset);
}

void BadRecords::add(const RecordView* record, std::size_t at, std::size_t bytes, const char* reason) {
  has_lost_track = record == nullptr;
  if (record != nullptr && record->opcode == Opcode::kMessage) ++messages;
  if (!first.empty()) return;
  first = (record != nullptr ? "the " + opcodeName(record->opcode) + " of " + std::to_string(bytes) + " bytes"
                             : "all of the " + std::to_string(bytes) + " bytes") +
          " from byte " + std::to_string(at) + " of them on: " + reason;
}

void readContents(ByteView records, Declarations& declarations, Contents& found) {
  ContentsReader reader(declarations, found);
  found.bad = forEachRecord(records, [&](const RecordView& record, std::size_t at) {
    switch (record.opcode) {
      case Opcode::kSchema: reader.take(decodeSchema(record.body)); break;
      case Opcode::kChannel: reader.take(decodeChannel(record.body)); break;
      case Opcode::kMessage: reader.take(decodeMessage(record.body), at); break;
      default: ++(record.opcode > Opcode::kDataEnd ? found.unknown : found.misplaced[record.opcode]);
    }
  });
  reader.finish();
}

Damage badIn(const Contents& found) {
  return {.offset = found.extent.offset,
          .reason = "messages or records in the " + placeOf(found.extent) + " cannot be read: " + found.bad.first,
          .messages = found.bad.messages};
}

Damage undeclaredIn(const Contents& found) {
  constexpr std::size_t kMostNamed = 8;
  Damage lost{.offset = found.extent.offset};
  std::string channels;
  std::size_t named = 0;
  for (const auto& [id, count] : found.undeclared) {
    lost.messages += count;
    if (++named <= kMostNamed) channels += (channels.empty() ? "" : ", ") + numberOf(id);
  }
  if (named > kMostNamed) channels += " and more";
  lost.reason =
      "messages in the " + placeOf(found.extent) + " belong to channels that are not declared before them: " + channels;
  return lost;
}

Damage misplacedIn(const Contents& found) {
  std::string records;
  for (const auto& [kind, count] : found.misplaced) {
    records += (records.empty() ? "" : ", ") + std::to_string(count) + " " + opcodeName(kind);
  }
  return {.offset = found.extent.offset,
          .reason = "the " + placeOf(found.extent) + " holds what has no place in one and is left out: " + records};
}

}  // namespace baton::mcap
