/// What the records of a chunk, or of a run of records outside of any chunk, say.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mcap/declarations.hpp"

namespace baton::mcap {

struct Contents {
  Extent extent{};                                  // with the times, channels and meanings of its messages
  std::map<ChannelId, std::uint64_t> counts{};      // of messages, by the channel's id in the index
  std::map<ChannelId, std::uint64_t> undeclared{};  // those that are lost, by the id in the file
  std::map<ChannelId, std::vector<MessageIndex::Entry>> entries{};  // what message indexes have to say, likewise
  std::vector<std::string> contradictions{};                        // see FileInfo
};

/// Takes the declarations, also when a later record cannot be read, and goes through the messages. One of a channel
/// that is declared nowhere before it, nor in these records, is lost alone. Throws FormatError at a record that cannot
/// be read.
void readContents(ByteView records, Declarations& declarations, Contents& found);

/// "chunk at byte 29".
[[nodiscard]] std::string placeOf(const Extent& extent);

}  // namespace baton::mcap
