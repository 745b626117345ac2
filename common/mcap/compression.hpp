/// Chunk compression: zstd frames and LZ4 frames, with contexts and buffers kept from one chunk to the next.
#pragma once

#include <memory>
#include <string_view>

#include "mcap/bytes.hpp"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;
struct LZ4F_cctx_s;
struct LZ4F_dctx_s;

namespace baton::mcap {

enum class Compression { kNone, kLz4, kZstd };

/// The name in the file: "", "lz4" or "zstd".
[[nodiscard]] std::string_view compressionName(Compression compression);
/// Throws FormatError for a name that is none of these.
[[nodiscard]] Compression compressionFromName(std::string_view name);

struct ContextDeleter {
  void operator()(ZSTD_CCtx_s* context) const;
  void operator()(ZSTD_DCtx_s* context) const;
  void operator()(LZ4F_cctx_s* context) const;
  void operator()(LZ4F_dctx_s* context) const;
};

class Compressor {
 public:
  /// @param level  zstd: up to 22, negative is faster; lz4: up to 12, negative is faster. 0 is the library's own
  /// default
  ///               (zstd 3, lz4 fast). Throws UsageError when out of range.
  Compressor(Compression compression, int level);

  [[nodiscard]] Compression compression() const { return compression_; }
  /// One frame holding `plain`, valid until the next call; `plain` itself without compression.
  [[nodiscard]] ByteView compress(ByteView plain);

 private:
  [[nodiscard]] ByteView compressZstd(ByteView plain);
  [[nodiscard]] ByteView compressLz4(ByteView plain);

  Compression compression_;
  int level_;
  std::unique_ptr<ZSTD_CCtx_s, ContextDeleter> zstd_;
  std::unique_ptr<LZ4F_cctx_s, ContextDeleter> lz4_;
  Buffer buffer_;
};

class Decompressor {
 public:
  /// The `plain_size` bytes held in the frames of `packed`, in `storage`. Never writes beyond plain_size. Throws
  /// FormatError when the frames are damaged, cut, or hold another number of bytes.
  /// @param compression  kLz4 or kZstd.
  [[nodiscard]] ByteView decompress(Compression compression, ByteView packed, std::size_t plain_size, Buffer& storage);

 private:
  void decompressZstd(ByteView packed, std::span<std::byte> plain);
  void decompressLz4(ByteView packed, std::span<std::byte> plain);

  std::unique_ptr<ZSTD_DCtx_s, ContextDeleter> zstd_;
  std::unique_ptr<LZ4F_dctx_s, ContextDeleter> lz4_;
};

}  // namespace baton::mcap
