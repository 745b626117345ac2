#include "mcap/compression.hpp"

#include <lz4frame.h>
#include <lz4hc.h>
#include <zstd.h>

#include <new>
#include <string>

namespace baton::mcap {
namespace {

/// Failures of compression are ours or the machine's, never the input's.
std::size_t checkedZstd(std::size_t result) {
  if (ZSTD_isError(result)) throw WriteError(std::string("zstd cannot compress: ") + ZSTD_getErrorName(result));
  return result;
}

std::size_t checkedLz4(std::size_t result) {
  if (LZ4F_isError(result)) throw WriteError(std::string("lz4 cannot compress: ") + LZ4F_getErrorName(result));
  return result;
}

[[noreturn]] void throwSize(const char* codec, std::uint64_t found, std::size_t expected) {
  throw FormatError(std::string(codec) + " data hold " + std::to_string(found) + " bytes, " + std::to_string(expected) +
                    " were declared");
}

}  // namespace

std::string_view compressionName(Compression compression) {
  switch (compression) {
    case Compression::kNone: return "";
    case Compression::kLz4: return "lz4";
    case Compression::kZstd: return "zstd";
  }
  return "";
}

Compression compressionFromName(std::string_view name) {
  for (const Compression known : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
    if (name == compressionName(known)) return known;
  }
  throw FormatError("compression \"" + std::string(name.substr(0, 64)) + "\" is not known, only lz4 and zstd are");
}

void ContextDeleter::operator()(ZSTD_CCtx_s* context) const { ZSTD_freeCCtx(context); }
void ContextDeleter::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }
void ContextDeleter::operator()(LZ4F_cctx_s* context) const { LZ4F_freeCompressionContext(context); }
void ContextDeleter::operator()(LZ4F_dctx_s* context) const { LZ4F_freeDecompressionContext(context); }

Compressor::Compressor(Compression compression, int level) : compression_(compression), level_(level) {
  const int highest = compression == Compression::kLz4 ? LZ4HC_CLEVEL_MAX : ZSTD_maxCLevel();
  if (compression != Compression::kNone && (level > highest || level < ZSTD_minCLevel())) {
    throw UsageError("compression level " + std::to_string(level) + " is out of range, the highest for " +
                     std::string(compressionName(compression)) + " is " + std::to_string(highest));
  }
  if (compression == Compression::kZstd) {
    zstd_.reset(ZSTD_createCCtx());
    if (!zstd_) throw std::bad_alloc();
    checkedZstd(ZSTD_CCtx_setParameter(zstd_.get(), ZSTD_c_compressionLevel, level));
  } else if (compression == Compression::kLz4) {
    LZ4F_cctx_s* context = nullptr;
    checkedLz4(LZ4F_createCompressionContext(&context, LZ4F_VERSION));
    lz4_.reset(context);
  }
}

ByteView Compressor::compress(ByteView plain) {
  switch (compression_) {
    case Compression::kNone: return plain;
    case Compression::kLz4: return compressLz4(plain);
    case Compression::kZstd: return compressZstd(plain);
  }
  return plain;
}

ByteView Compressor::compressZstd(ByteView plain) {
  const std::span<std::byte> out = buffer_.resize(ZSTD_compressBound(plain.size()));
  return out.first(checkedZstd(ZSTD_compress2(zstd_.get(), out.data(), out.size(), plain.data(), plain.size())));
}

ByteView Compressor::compressLz4(ByteView plain) {
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  preferences.frameInfo.blockSizeID = LZ4F_max1MB;
  preferences.frameInfo.contentSize = plain.size();
  preferences.compressionLevel = level_;
  preferences.autoFlush = 1;  // the whole chunk is here: nothing to gather in a second buffer
  const std::span<std::byte> out = buffer_.resize(LZ4F_compressFrameBound(plain.size(), &preferences));
  std::size_t size = checkedLz4(LZ4F_compressBegin(lz4_.get(), out.data(), out.size(), &preferences));
  size += checkedLz4(
      LZ4F_compressUpdate(lz4_.get(), out.data() + size, out.size() - size, plain.data(), plain.size(), nullptr));
  size += checkedLz4(LZ4F_compressEnd(lz4_.get(), out.data() + size, out.size() - size, nullptr));
  return out.first(size);
}

ByteView Decompressor::decompress(Compression compression, ByteView packed, std::size_t plain_size, Buffer& storage) {
  if (compression == Compression::kNone) return packed;
  const std::span<std::byte> plain = storage.resize(plain_size);
  if (compression == Compression::kZstd) {
    decompressZstd(packed, plain);
  } else {
    decompressLz4(packed, plain);
  }
  return plain;
}

void Decompressor::decompressZstd(ByteView packed, std::span<std::byte> plain) {
  if (!zstd_) {
    zstd_.reset(ZSTD_createDCtx());
    if (!zstd_) throw std::bad_alloc();
  }
  const std::size_t size = ZSTD_decompressDCtx(zstd_.get(), plain.data(), plain.size(), packed.data(), packed.size());
  if (ZSTD_isError(size)) throw FormatError(std::string("zstd data are damaged: ") + ZSTD_getErrorName(size));
  if (size != plain.size()) throwSize("zstd", size, plain.size());
}

void Decompressor::decompressLz4(ByteView packed, std::span<std::byte> plain) {
  if (!lz4_) {
    LZ4F_dctx_s* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) throw std::bad_alloc();
    lz4_.reset(context);
  }
  LZ4F_resetDecompressionContext(lz4_.get());
  std::size_t wanted = 0;  // what the decoder still expects; 0 at the end of a frame
  std::size_t filled = 0;
  while (!packed.empty()) {
    std::size_t consumed = packed.size();
    std::size_t produced = plain.size() - filled;
    wanted = LZ4F_decompress(lz4_.get(), plain.data() + filled, &produced, packed.data(), &consumed, nullptr);
    if (LZ4F_isError(wanted)) throw FormatError(std::string("lz4 data are damaged: ") + LZ4F_getErrorName(wanted));
    filled += produced;
    packed = packed.subspan(consumed);
    // Neither taking nor giving: the output is full and the frame wants to write on.
    if (consumed == 0 && produced == 0) break;
  }
  if (!packed.empty())
    throw FormatError("lz4 data hold more than the " + std::to_string(plain.size()) + " bytes declared");
  if (wanted != 0) throw FormatError("lz4 data end in the middle of a frame");
  if (filled != plain.size()) throwSize("lz4", filled, plain.size());
}

}  // namespace baton::mcap
