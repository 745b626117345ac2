#include "mcap/search.hpp"

#include <algorithm>

#include "mcap/shape.hpp"

namespace baton::mcap {
namespace {

/// It is looked for in pieces that grow from the first size up to the second: it may be near, often.
constexpr std::uint64_t kFirstBytes = 4 << 10;
constexpr std::uint64_t kMostBytes = 4 << 20;

}  // namespace

std::optional<std::uint64_t> Search::dataAfter(std::uint64_t torn, bool has_loose) {
  const bool may_hold = mayHoldRecording(file_, torn);
  const bool is_attachment =
      Opcode{static_cast<std::uint8_t>(numberAt<std::uint8_t>(file_, torn))} == Opcode::kAttachment;
  std::optional<std::uint64_t> recording;  // the first, in a damaged attachment or behind what is torn
  bool is_inside = false;                  // of it
  std::uint64_t size = kFirstBytes;
  for (std::uint64_t from = torn + 1; from + kRecordHeadBytes < file_.size();
       from += size, size = std::min(2 * size, kMostBytes)) {
    // Records that begin in this piece are looked at whole, and so is a magic: it ends behind it.
    const std::span<std::byte> window =
        storage_.resize(static_cast<std::size_t>(std::min(size + kMagic.size() - 1, file_.size() - from)));
    file_.read(from, window);
    for (std::size_t i = 0; i < std::min<std::uint64_t>(size, window.size()); ++i) {
      if (std::ranges::equal(ByteView(window).subspan(i).first(std::min(kMagic.size(), window.size() - i)), kMagic)) {
        if (beginsRecording(file_, from + i + kMagic.size())) return recording.value_or(from + i + kMagic.size());
        if (beginsRecording(file_, from + i)) {
          if (!may_hold) return from + i;
          if (!recording && !is_attachment) recording = from + i;
        }
        is_inside = !is_inside;
      }
      const auto opcode = Opcode{std::to_integer<std::uint8_t>(window[i])};
      if (!is_inside && mayGoOnAt(from + i, opcode, has_loose)) return from + i;
    }
  }
  return recording;
}

/// Lengths of a few bytes may fit by chance: there the next record must begin, too.
bool Search::mayGoOnAt(std::uint64_t offset, Opcode opcode, bool has_loose) const {
  if (opcode == Opcode::kSchema || opcode == Opcode::kChannel || opcode == Opcode::kMessage) {
    return has_loose && beginsChain(offset);
  }
  const bool is_long = opcode == Opcode::kChunk || opcode == Opcode::kAttachment;
  if (!is_long && opcode != Opcode::kMetadata && opcode != Opcode::kDataEnd) return false;
  const RecordPlace place{
      .opcode = opcode, .offset = offset, .body_length = numberAt<std::uint64_t>(file_, offset + 1)};
  if (place.body_length >= file_.size() || place.end() > file_.size() || !fits(file_, place)) return false;
  if (opcode == Opcode::kMetadata) return beginsRecord(file_, place.end(), false);
  return is_long || (place.body_length == leastBytes(opcode) && beginsIndex(file_, place.end()));
}

/// Messages have no shape but their length: it has to lead to another record, and that to a third.
bool Search::beginsChain(std::uint64_t offset) const {
  constexpr int kRecords = 3;
  for (int i = 0; i < kRecords; ++i) {
    if (!beginsRecord(file_, offset, false)) return false;
    offset += kRecordHeadBytes + numberAt<std::uint64_t>(file_, offset + 1);
  }
  return true;
}

std::optional<std::uint64_t> Search::recordingBeyond(std::uint64_t record, std::uint64_t end) {
  std::optional<std::uint64_t> first;
  bool is_open = false;
  forEachMagic(record + kRecordHeadBytes, end, [&](std::uint64_t at) {
    if (!first && beginsRecording(file_, at)) first = at;
    if (first) is_open = !is_open;
    return true;
  });
  return is_open ? first : std::nullopt;
}

std::optional<std::uint64_t> Search::recordingIn(std::uint64_t from, std::uint64_t end) {
  std::optional<std::uint64_t> first;
  forEachMagic(from, end, [&](std::uint64_t at) {
    if (beginsRecording(file_, at)) first = at;
    return !first;
  });
  return first;
}

/// Those that begin from one byte on and before the other. @param use  returns whether it wants the next one, too.
template <class Use>
void Search::forEachMagic(std::uint64_t from, std::uint64_t end, Use use) {
  end = std::min(end, file_.size());
  for (std::uint64_t size = kFirstBytes; from < end; from += size, size = std::min(2 * size, kMostBytes)) {
    // One that begins in this piece is looked at whole.
    const std::uint64_t bytes = std::min(std::min(end - from, size) + kMagic.size() - 1, file_.size() - from);
    const std::span<std::byte> window = storage_.resize(static_cast<std::size_t>(bytes));
    file_.read(from, window);
    for (auto magic = window.begin();; magic += kMagic.size()) {
      magic = std::search(magic, window.end(), kMagic.begin(), kMagic.end());
      if (magic == window.end()) break;
      if (!use(from + static_cast<std::uint64_t>(magic - window.begin()))) return;
    }
  }
}

}  // namespace baton::mcap
