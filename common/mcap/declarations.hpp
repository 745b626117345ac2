/// What the ids of schemas and channels mean while a file is read from its start.
///
/// The format gives an id one meaning in a file. Where a file gives it several, the later one counts from its
/// declaration on, and each has an id of its own in the index: no reader of the index takes one for the other.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mcap/index.hpp"

namespace baton::mcap {

class Declarations {
 public:
  /// @param index     gets every schema and channel that is declared.
  /// @param fallback  what an id means that is used and was declared nowhere before: a summary's; null when there is
  /// none.
  Declarations(FileIndex& index, const FileIndex* fallback) : index_(index), fallback_(fallback) {}

  /// Take a declaration; return what the id meant until then, if that is something else. Throw FormatError when more
  /// meanings are declared than there are ids.
  std::optional<Schema> take(Schema schema);
  std::optional<Channel> take(Channel channel);
  /// The id, in the index, of the channel that messages with this id belong to; nothing when it is not declared.
  [[nodiscard]] std::optional<ChannelId> meaningOf(ChannelId id);
  /// At the end of a recording: the channels whose schema is declared nowhere, a sentence each. A schema that only the
  /// fallback declares is taken from there.
  [[nodiscard]] std::vector<std::string> withoutSchema();
  /// Another recording begins: no id means anything any more.
  void forget();

 private:
  struct Live {
    Channel declared{};  // as in the file
    ChannelId means{};   // in the index
    std::uint64_t generation = 0;
  };
  void resolve(Live& live);

  FileIndex& index_;
  const FileIndex* fallback_;
  std::map<SchemaId, SchemaId> schemas_;       // by the id in the file: the id in the index
  std::uint64_t generation_ = 1;               // of the line above: channels are resolved again when it has changed
  std::vector<std::optional<Live>> channels_;  // [id in the file]
  std::map<std::string, SchemaId> renamed_schemas_;  // those that could not keep their id, by what they declare
  std::map<std::string, ChannelId> renamed_channels_;
  unsigned free_schema_ = 0xFFFF;  // the next to try
  unsigned free_channel_ = 0xFFFF;
};

}  // namespace baton::mcap
