#include "mcap/compression.hpp"

#include "mcap/crc.hpp"
#include "recording.hpp"

namespace baton::mcap {
namespace {

class CompressionTest : public testing::TestWithParam<Compression> {};
INSTANTIATE_TEST_SUITE_P(Codecs, CompressionTest, testing::Values(Compression::kLz4, Compression::kZstd),
                         [](const auto& tested) { return std::string(compressionName(tested.param)); });

TEST_P(CompressionTest, GivesBackEverySizeWithOneContext) {
  for (const int level : {-5, 0, 9}) {
    Compressor compressor(GetParam(), level);
    Decompressor decompressor;
    Buffer storage;
    for (const std::size_t size : {0, 1, 100, 65'536, 3'000'001, 7}) {
      const Bytes plain = payload(size, 1);
      const ByteView packed = compressor.compress(plain);
      EXPECT_TRUE(std::ranges::equal(decompressor.decompress(GetParam(), packed, size, storage), plain));
    }
  }
}

TEST_P(CompressionTest, MakesDataSmaller) {
  const Bytes plain(100'000);
  EXPECT_LT(Compressor(GetParam(), 0).compress(plain).size(), 1000U);
}

TEST_P(CompressionTest, EveryCutIsNoticed) {
  const Bytes plain = payload(500, 1);
  Compressor compressor(GetParam(), 0);
  const ByteView packed = compressor.compress(plain);
  Decompressor decompressor;
  Buffer storage;
  for (std::size_t size = 0; size < packed.size(); ++size) {
    EXPECT_THROW(static_cast<void>(decompressor.decompress(GetParam(), packed.first(size), plain.size(), storage)),
                 FormatError)
        << size;
  }
  // A failure leaves nothing behind.
  EXPECT_TRUE(std::ranges::equal(decompressor.decompress(GetParam(), packed, plain.size(), storage), plain));
}

TEST_P(CompressionTest, NeverWritesMoreThanDeclared) {
  const Bytes plain(1 << 20);  // compresses to almost nothing: a small bomb
  Compressor compressor(GetParam(), 0);
  const ByteView packed = compressor.compress(plain);
  Decompressor decompressor;
  for (const std::size_t declared : {std::size_t{0}, std::size_t{10}, plain.size() - 1, plain.size() + 1}) {
    Buffer storage;  // sized to the claim, so that a sanitizer sees any byte too many
    EXPECT_THROW(static_cast<void>(decompressor.decompress(GetParam(), packed, declared, storage)), FormatError);
  }
}

TEST_P(CompressionTest, ReadsFramesInARow) {
  const Bytes plain = payload(5000, 1);
  Compressor compressor(GetParam(), 0);
  Bytes packed;
  append(packed, compressor.compress(ByteView(plain).first(2000)));
  append(packed, compressor.compress(ByteView(plain).subspan(2000)));
  Decompressor decompressor;
  Buffer storage;
  EXPECT_TRUE(std::ranges::equal(decompressor.decompress(GetParam(), packed, plain.size(), storage), plain));
}

TEST(Crc, IsTheStandardOne) {
  EXPECT_EQ(crc32(asBytes("123456789")), 0xCBF43926U);  // the check value of CRC-32 in every catalogue
  EXPECT_EQ(crc32({}), 0U);
  EXPECT_EQ(crc32(payload(1000, 1)), crcByBits(payload(1000, 1)));
}

TEST(Crc, GoesOnAndJoins) {
  const Bytes bytes = payload(1000, 1);
  for (const std::size_t split : {0, 1, 500, 1000}) {
    const ByteView first = ByteView(bytes).first(split);
    const ByteView second = ByteView(bytes).subspan(split);
    EXPECT_EQ(crc32(second, crc32(first)), crc32(bytes));
    EXPECT_EQ(crc32Joined(crc32(first), crc32(second), second.size()), crc32(bytes));
  }
}

}  // namespace
}  // namespace baton::mcap
