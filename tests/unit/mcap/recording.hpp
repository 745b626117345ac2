/// What the recording tests share: a folder that goes away, files as bytes, messages by value, and an independent look
/// at a file's records.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "mcap/reader.hpp"
#include "mcap/writer.hpp"

namespace baton::mcap {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "baton-mcap-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline Bytes loadFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const ByteView bytes = asBytes(text);
  return {bytes.begin(), bytes.end()};
}

inline void saveFile(const std::filesystem::path& path, ByteView bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// Half noise, half zeros: compressible, but not to nothing.
inline Bytes payload(std::size_t size, unsigned seed) {
  std::mt19937 generator(seed);
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; i += 2) bytes[i] = static_cast<std::byte>(generator());
  return bytes;
}

/// A message by value.
struct Sample {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::uint64_t publish_time_ns = 0;
  Bytes data;
  bool operator==(const Sample&) const = default;
};

inline std::vector<Sample> samplesOf(const Reader& reader, const MessageFilter& filter = {}) {
  std::vector<Sample> samples;
  reader.forEachMessage(filter, [&](const MessageView& message) {
    samples.push_back({.topic = message.channel->topic,
                       .sequence = message.sequence,
                       .log_time_ns = message.log_time_ns,
                       .publish_time_ns = message.publish_time_ns,
                       .data = Bytes(message.data.begin(), message.data.end())});
  });
  return samples;
}

inline std::vector<std::uint64_t> logTimesOf(const Reader& reader, const MessageFilter& filter = {}) {
  std::vector<std::uint64_t> times;
  for (const Sample& sample : samplesOf(reader, filter)) times.push_back(sample.log_time_ns);
  return times;
}

/// A record found by walking over the bytes by hand, without the library's decoders.
struct RawRecord {
  std::uint8_t opcode;
  std::size_t offset;
  ByteView body;
  [[nodiscard]] std::size_t end() const { return offset + 9 + body.size(); }
};

template <class Number>
Number numberAt(ByteView bytes, std::size_t offset) {
  Number value{};
  std::memcpy(&value, bytes.subspan(offset, sizeof(Number)).data(), sizeof(Number));
  return value;
}

/// The records between the two magics.
inline std::vector<RawRecord> rawRecords(ByteView file) {
  std::vector<RawRecord> records;
  for (std::size_t at = 8; at + 8 < file.size(); at = records.back().end()) {
    records.push_back({.opcode = static_cast<std::uint8_t>(file[at]),
                       .offset = at,
                       .body = file.subspan(at + 9, numberAt<std::uint64_t>(file, at + 1))});
  }
  return records;
}

inline std::vector<int> opcodesOf(const std::vector<RawRecord>& records) {
  std::vector<int> opcodes;
  opcodes.reserve(records.size());
  for (const RawRecord& record : records) opcodes.push_back(record.opcode);
  return opcodes;
}

/// CRC-32 bit by bit, from its definition (reflected polynomial 0xEDB88320).
inline std::uint32_t crcByBits(ByteView bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

/// Records by hand, for files our writer would not write.
class FileBuilder {
 public:
  FileBuilder() {
    append(bytes, kMagic);
    appendHeader(bytes, {.profile = "", .library = "builder"});
  }
  void chunk(ByteView records, std::uint64_t start, std::uint64_t end) {
    appendChunkHead(bytes, {.start_time_ns = start,
                            .end_time_ns = end,
                            .plain_size = records.size(),
                            .plain_crc = crcByBits(records),
                            .records = records});
    append(bytes, records);
  }
  void record(std::uint8_t opcode, ByteView body) { rawRecord(bytes, opcode, body); }
  static void rawRecord(Bytes& out, std::uint8_t opcode, ByteView body) {
    appendNumber(out, opcode);
    appendNumber(out, std::uint64_t{body.size()});
    append(out, body);
  }
  /// DataEnd, a footer without a summary, magic.
  void finish() {
    appendDataEnd(bytes, {});
    appendFooter(bytes, {});
    append(bytes, kMagic);
  }

  Bytes bytes;
};

}  // namespace baton::mcap
