#include "mcap/foreign.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "mcap/foreign_format.hpp"
#include "mcap/search.hpp"
#include "mcap/shape.hpp"

namespace baton::mcap {
namespace {

std::string beginOf(const InputFile& file) {
  std::string begin(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), 64)), '\0');
  file.read(0, std::as_writable_bytes(std::span(begin)));
  return begin;
}

/// The digit in the magic of another version of MCAP; nothing when it begins otherwise.
std::optional<char> otherVersion(const std::string& begin) {
  constexpr std::size_t kVersionAt = 5;
  const bool is_one = begin.starts_with("\x89MCAP") && begin.find("\r\n") == kVersionAt + 1;
  return is_one && std::isdigit(static_cast<unsigned char>(begin[kVersionAt])) != 0 ? std::optional(begin[kVersionAt])
                                                                                    : std::nullopt;
}

/// The line end in the magic is there to tell of transfers that change line ends.
bool isChangedAsText(const std::string& begin) {
  constexpr std::size_t kMostInFront = 3;  // in UTF-8 the first byte has become up to three
  const std::size_t end = std::min(begin.find("MCAP0"), kMostInFront + 1) + 5;
  return end <= kMostInFront + 5 && end < begin.size() && (begin[end] == '\r' || begin[end] == '\n');
}

/// Files that are given in the place of a recording: what they are, and what to do.
std::string whatBeginsWith(const std::string& begin) {
  if (isChangedAsText(begin)) {
    return "it is an MCAP file whose line ends or characters were changed, as by a transfer in text mode: transfer it "
           "again, in binary mode";
  }
  if (begin.empty()) return "it is empty, nothing was written into it; give another file";
  if (const ForeignFormat* format = foreignFormat(begin)) {
    const std::string remedy = format->remedy;
    return std::string("it is ") + format->what +
           (remedy.empty() ? "; give a recording, whose name ends in .mcap" : ": " + remedy);
  }
  if (begin.find_first_not_of('\0') == std::string::npos) {
    return "it begins with " + zerosText(begin.size()) + "; what it was cannot be told, use a copy of it";
  }
  const std::size_t text = std::min(begin.find_first_not_of(" \t\r\n\xef\xbb\xbf"), begin.size());
  if (begin[std::min(text, begin.size() - 1)] == '<') {
    return "it is XML, as a robot description (URDF) is; a recording ends in .mcap";
  }
  const bool is_text =
      std::ranges::none_of(begin, [](unsigned char c) { return std::iscntrl(c) != 0 && std::isspace(c) == 0; });
  if (is_text) return "it is text and does not begin with the MCAP magic; give a recording";
  return "it does not begin with the MCAP magic, and nothing in it does; give a recording";
}

}  // namespace

std::uint64_t firstRecording(const InputFile& file) {
  if (hasMagic(file, 0)) return 0;
  const std::string begin = beginOf(file), refusal = file.path().string() + " is not an MCAP recording: ";
  if (const std::optional<char> version = otherVersion(begin)) {
    throw NotARecording(refusal + "it is an MCAP file of version " + *version +
                        ", expected version 0: write it, or convert it, in that one");
  }
  if (beginsWithHeader(file, kMagic.size())) return 0;
  if (const std::optional<std::uint64_t> found = Search(file).recordingIn(0, file.size())) return *found;
  throw NotARecording(refusal + whatBeginsWith(begin));
}

Damage foreignBytes(const InputFile& file, std::uint64_t offset, std::uint64_t length) {
  const bool is_zero = zerosAt(file, offset, offset + length) == length;
  const std::string s = length == 1 ? "s" : "";
  const std::string where = offset == 0 ? " come" + s + " before the recording at byte " + std::to_string(length)
                                        : " follow" + s + " the end of the recording at byte " + std::to_string(offset);
  return {.offset = offset,
          .length = length,
          .reason = std::to_string(length) + (is_zero ? " zero" : "") + (length == 1 ? " byte" : " bytes") + where +
                    " and belong" + s + " to none"};
}

std::string describeForeign(const std::vector<Damage>& foreign) {
  if (foreign.empty()) return "";
  const std::size_t more = foreign.size() - 1;
  return foreign.front().reason +
         (more == 0 ? "" : ", others are in " + std::to_string(more) + (more == 1 ? " more place" : " more places")) +
         " (`bag recover` makes a copy without them)";
}

}  // namespace baton::mcap
