/// Where reading can continue after damage: looks through the bytes of a file for what has the shape of a record.
#pragma once

#include <cstdint>
#include <optional>

#include "mcap/index.hpp"

namespace baton::mcap {

class Search {
 public:
  explicit Search(const InputFile& file) : file_(file) {}

  /// Where the next chunk, attachment or metadata record begins, the data end, or another recording, after what is torn
  /// there. A recording that is attached to this one has chunks that are not of this one: attachments are found whole,
  /// and of one whose own beginning is damaged the magic tells. Two magics are the end of this recording and the
  /// beginning of another that was joined to it; one is when what is torn holds no recording, or when nothing of this
  /// one follows.
  /// @param has_loose  the recording has messages outside of chunks: where several records follow one another the first
  /// of them may be one, too.
  [[nodiscard]] std::optional<std::uint64_t> dataAfter(std::uint64_t torn, bool has_loose);

  /// The first recording that begins from one byte on and before the other.
  [[nodiscard]] std::optional<std::uint64_t> recordingIn(std::uint64_t from, std::uint64_t end);

  /// The recording that begins in a record and ends after it: of those that lie in it each magic has a second one.
  [[nodiscard]] std::optional<std::uint64_t> recordingBeyond(std::uint64_t record, std::uint64_t end);

 private:
  template <class Use>
  void forEachMagic(std::uint64_t from, std::uint64_t end, Use use);
  [[nodiscard]] bool mayGoOnAt(std::uint64_t offset, Opcode opcode, bool has_loose) const;
  [[nodiscard]] bool beginsChain(std::uint64_t offset) const;

  const InputFile& file_;
  Buffer storage_;
};

}  // namespace baton::mcap
