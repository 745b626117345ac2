/// Loads the records of a chunk, or of a run of records outside of any chunk, and checks them.
#pragma once

#include "mcap/compression.hpp"
#include "mcap/index.hpp"

namespace baton::mcap {

class ExtentLoader {
 public:
  ExtentLoader(const InputFile& file, const ReaderOptions& options) : file_(file), options_(options) {}

  /// The extent's records, decompressed, in `storage`. Throws FormatError, without place, when lengths or the CRC are
  /// wrong: run it inside guarded(); and UsageError when the file decompresses to more than the options allow.
  [[nodiscard]] ByteView load(const Extent& extent, Buffer& storage);

  /// Whether the caller wants what is left when something is damaged.
  [[nodiscard]] bool isTolerant() const { return options_.on_damage != nullptr; }

  /// Runs work() on an extent. A FormatError in it goes to options.on_damage (false is returned) or on to the caller,
  /// with the place in the file added.
  template <class Work>
  bool guarded(const Extent& extent, Work work) const {
    const std::optional<Damage> damage = attempt(extent, work);
    if (damage) options_.on_damage(*damage);
    return !damage;
  }

  /// The same, for a caller who will report the damage that is returned.
  template <class Work>
  [[nodiscard]] std::optional<Damage> attempt(const Extent& extent, Work work) const {
    try {
      work();
      return std::nullopt;
    } catch (const FormatError& error) {
      const std::string what = extent.is_chunk ? "chunk" : "records";
      if (!isTolerant()) {
        throw FormatError(file_.path().string() + ": " + what + " at byte " + std::to_string(extent.offset) + ": " +
                          error.what());
      }
      return Damage{.offset = extent.offset,
                    .length = extent.length,
                    .reason = error.what(),
                    .chunks = extent.is_chunk ? std::uint64_t{1} : 0};
    }
  }

 private:
  void allow(std::uint64_t plain_bytes);

  const InputFile& file_;
  const ReaderOptions& options_;
  std::uint64_t inflated_bytes_ = 0;  // in all
  Decompressor decompressor_;
  Buffer packed_;
};

}  // namespace baton::mcap
