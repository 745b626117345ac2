#include "mcap/extent.hpp"

#include <algorithm>
#include <utility>

#include "mcap/crc.hpp"

namespace baton::mcap {

void ExtentLoader::allow(std::uint64_t plain_bytes) {
  inflated_bytes_ += plain_bytes;
  const std::uint64_t most = std::max(options_.max_inflated_bytes, kMostInflation * file_.size());
  if (inflated_bytes_ <= most) return;
  throw UsageError(file_.path().string() + ": expected at most " + std::to_string(most >> 20) +
                   " MiB of decompressed data in a file of " + std::to_string(file_.size()) +
                   " bytes, found more: it may be made to exhaust its reader. If you trust it, `mcap decompress` makes "
                   "a copy that is read without a limit");
}

ByteView ExtentLoader::load(const Extent& extent, Buffer& storage) {
  if (extent.length > options_.max_chunk_bytes) {
    throw FormatError("its " + std::to_string(extent.length) + " bytes are above the limit of " +
                      std::to_string(options_.max_chunk_bytes));
  }
  const std::span<std::byte> bytes = packed_.resize(static_cast<std::size_t>(extent.length));
  file_.read(extent.offset, bytes);
  if (!extent.is_chunk) {
    std::swap(packed_, storage);
    return bytes;
  }

  ByteReader in(bytes);
  const std::optional<RecordView> record = nextRecord(in);
  if (!record || record->opcode != Opcode::kChunk || !in.empty()) throw FormatError("the index points at no chunk");
  const Chunk chunk = decodeChunk(record->body);
  const Compression compression = compressionFromName(chunk.compression);
  if (chunk.plain_size > options_.max_chunk_bytes) {
    throw FormatError("it claims " + std::to_string(chunk.plain_size) +
                      " bytes once decompressed, above the limit of " + std::to_string(options_.max_chunk_bytes));
  }
  ByteView records = chunk.records;
  if (compression == Compression::kNone) {
    if (records.size() != chunk.plain_size) {
      throw FormatError("it claims " + std::to_string(chunk.plain_size) + " bytes and holds " +
                        std::to_string(records.size()));
    }
    std::swap(packed_, storage);
  } else {
    allow(chunk.plain_size);
    records = decompressor_.decompress(compression, records, static_cast<std::size_t>(chunk.plain_size), storage);
  }
  if (options_.check_crc && chunk.plain_crc != 0) {
    if (const std::uint32_t found = crc32(records); found != chunk.plain_crc) {
      throw FormatError("its CRC is " + std::to_string(found) + " where " + std::to_string(chunk.plain_crc) +
                        " was recorded: the data are damaged");
    }
  }
  return records;
}

}  // namespace baton::mcap
