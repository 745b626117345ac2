/// What the records of a chunk, or of a run of records outside of any chunk, say.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mcap/declarations.hpp"

namespace baton::mcap {

/// Records that cannot be read, among others that can.
struct BadRecords {
  std::string first{};          // of them: which, where and why; empty when all are sound
  std::uint64_t messages = 0;   // among them, as far as they can be told
  bool has_lost_track = false;  // of where the next record begins
  void add(const RecordView* record, std::size_t at, std::size_t bytes, const char* reason);
};

/// Gives each record, and where it begins, to use(record, at). One for which that throws FormatError costs itself;
/// where the next one does not begin, the rest is lost.
template <class Use>
[[nodiscard]] BadRecords forEachRecord(ByteView records, Use use) {
  BadRecords bad;
  for (std::size_t at = 0, end = 0; at < records.size(); at = end) {
    std::optional<RecordView> record;
    const RecordView* whole = nullptr;  // GCC may have written into `record` by the time nextRecord() throws
    try {
      ByteReader in(records.subspan(at));
      end = records.size();
      record = nextRecord(in);
      end = at + in.position();
      whole = &*record;
      use(*whole, at);
    } catch (const FormatError& error) {
      bad.add(whole, at, end - at, error.what());
    }
  }
  return bad;
}

struct Contents {
  Extent extent{};                                  // with the times, channels and meanings of its messages
  std::map<ChannelId, std::uint64_t> counts{};      // of messages, by the channel's id in the index
  std::map<ChannelId, std::uint64_t> undeclared{};  // those that are lost, by the id in the file
  std::map<ChannelId, std::vector<MessageIndex::Entry>> entries{};  // what message indexes have to say, likewise
  std::vector<std::string> contradictions{};                        // see FileInfo
  std::map<Opcode, std::uint64_t> misplaced{};  // records in a chunk that have no place in one, by their kind
  std::uint64_t unknown = 0;                    // records of kinds that MCAP does not know
  BadRecords bad{};
};

/// Takes the declarations and goes through the messages. One of a channel that is declared nowhere before it, nor in
/// these records, is lost alone, and so is a record that cannot be read. A chunk has schemas, channels and messages;
/// other records in it are left out.
void readContents(ByteView records, Declarations& declarations, Contents& found);

/// What is lost with them, when there are any.
[[nodiscard]] Damage badIn(const Contents& found);
[[nodiscard]] Damage undeclaredIn(const Contents& found);
[[nodiscard]] Damage misplacedIn(const Contents& found);

/// "chunk at byte 29".
[[nodiscard]] std::string placeOf(const Extent& extent);

}  // namespace baton::mcap
