/// Every type of idl/ to bytes and back, and whatever else may arrive: short, long, foreign or random bytes.
#include "dds/codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "dds/hash.hpp"
#include "full_messages.hpp"
#include "msg/idl_text.hpp"
#include "support/allocation_guard.hpp"

namespace baton::dds {
namespace {

using Bytes = std::vector<std::byte>;
constexpr std::size_t kHeader = 4;

template <class T>
Bytes encoded(const T& message) {
  Bytes buffer(maxPayload<T>());
  const auto payload = encode(message, std::span(buffer));
  return {payload.begin(), payload.end()};
}

/// The payload of the same message from a sender of the other byte order.
template <class T>
Bytes encodedBigEndian(const T& message) {
  Bytes buffer(maxPayload<T>());
  msg::FastBuffer fast(reinterpret_cast<char*>(buffer.data()), buffer.size());
  msg::PlainCdr cdr(fast, msg::PlainCdr::BIG_ENDIANNESS);
  cdr.serialize_encapsulation();
  cdr << message;
  buffer.resize(cdr.length());
  return buffer;
}

void writeLength(Bytes& payload, std::size_t offset, std::uint32_t length) {
  std::memcpy(payload.data() + offset, &length, sizeof length);
}

/// Every length of a short payload; of a long one some of each remainder by the alignments, and its last ones.
template <class F>
void forLengthsBelow(std::size_t size, const F& f) {
  constexpr std::size_t kAll = 1500, kStride = 7, kLast = 16;
  for (std::size_t length = 0; length < size; length += size <= kAll || length + kLast >= size ? 1 : kStride) f(length);
}

template <class T>
class CodecTest : public testing::Test {};

TYPED_TEST_SUITE(CodecTest, test::AllTypes);

template <class... Types>
constexpr std::size_t countOf(testing::Types<Types...>) {
  return sizeof...(Types);
}

TEST(Codec, EveryTypeOfTheIdlIsTestedHere) { EXPECT_EQ(msg::allIdlTexts().size(), countOf(test::AllTypes{})); }

TYPED_TEST(CodecTest, AFullMessageSurvivesTheRoundTrip) {
  const auto message = test::full<TypeParam>();
  const Bytes payload = encoded(message);
  ASSERT_FALSE(payload.empty());
  TypeParam back;
  ASSERT_TRUE(decode(payload, back));
  EXPECT_EQ(back, message);
  EXPECT_EQ(encoded(back), payload);
}

TYPED_TEST(CodecTest, APayloadDependsOnNothingButTheMessage) {
  const auto message = test::full<TypeParam>();
  Bytes used(maxPayload<TypeParam>(), std::byte{0xAA});
  const auto payload = encode(message, std::span(used));
  EXPECT_EQ(Bytes(payload.begin(), payload.end()), encoded(message));
}

TYPED_TEST(CodecTest, AnEmptyMessageSurvivesTheRoundTrip) {
  const TypeParam message;
  TypeParam back = test::full<TypeParam>();
  ASSERT_TRUE(decode(encoded(message), back));
  EXPECT_EQ(back, message);
}

TYPED_TEST(CodecTest, TheOtherByteOrderIsRead) {
  const auto message = test::full<TypeParam>();
  TypeParam back;
  ASSERT_TRUE(decode(encodedBigEndian(message), back));
  EXPECT_EQ(back, message);
}

TYPED_TEST(CodecTest, PayloadsAreFilledUpWithZerosToAMultipleOfFour) {
  for (const auto& message : {test::full<TypeParam>(), TypeParam{}}) {
    const Bytes payload = encoded(message);
    const std::size_t unfilled = test::unfilledSize(message);
    ASSERT_EQ(payload.size(), (unfilled + 3) / 4 * 4);
    EXPECT_TRUE(std::all_of(payload.begin() + static_cast<std::ptrdiff_t>(unfilled), payload.end(),
                            [](std::byte b) { return b == std::byte{0}; }));
    const Bytes header{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};  // CDR, little-endian, no options
    EXPECT_TRUE(std::equal(header.begin(), header.end(), payload.begin()));
  }
}

TYPED_TEST(CodecTest, EqualMessagesAreEqualBytesWhateverTheBufferHeldBefore) {
  for (const auto& message : {test::full<TypeParam>(), TypeParam{}}) {
    Bytes buffer(maxPayload<TypeParam>(), std::byte{0xFF});
    const std::span<const std::byte> payload = encode(message, std::span(buffer));
    EXPECT_EQ(Bytes(payload.begin(), payload.end()), encoded(message));
  }
}

TYPED_TEST(CodecTest, AFullMessageFitsIntoMaxPayloadAndIntoNothingSmaller) {
  const auto message = test::full<TypeParam>();
  const std::size_t size = encoded(message).size();
  ASSERT_LE(size, maxPayload<TypeParam>());
  forLengthsBelow(size, [&](std::size_t room) {
    Bytes too_small(room);
    EXPECT_TRUE(encode(message, std::span(too_small)).empty()) << room;
  });
  Bytes buffer(size);
  EXPECT_EQ(encode(message, std::span(buffer)).size(), size);
}

TYPED_TEST(CodecTest, EncodingDoesNotAllocate) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  const auto message = test::full<TypeParam>();
  Bytes buffer(maxPayload<TypeParam>());
  const test::AllocationGuard guard;
  const bool fits = !encode(message, std::span(buffer)).empty();
  EXPECT_EQ(guard.count(), 0u);
  EXPECT_TRUE(fits);
}

TYPED_TEST(CodecTest, ATruncatedPayloadIsRefusedAtEveryLength) {
  for (const auto& message : {test::full<TypeParam>(), TypeParam{}}) {
    const Bytes payload = encoded(message);
    forLengthsBelow(test::unfilledSize(message), [&](std::size_t size) {
      const Bytes cut(payload.begin(),
                      payload.begin() + static_cast<std::ptrdiff_t>(size));  // its end is the heap block's
      TypeParam back;
      EXPECT_FALSE(decode(cut, back)) << size << " of " << payload.size();
    });
  }
}

TYPED_TEST(CodecTest, LengthsThatCannotBeAreRefusedWithoutMakingRoomForThem) {
  // Four billion entries somewhere in the payload, length field or not. Were room made for them, a sequence of doubles
  // would ask for 32 GB and fill it.
  const Bytes payload = encoded(test::full<TypeParam>());
  forLengthsBelow(payload.size() - kHeader - 3, [&](std::size_t place) {
    const std::size_t offset = kHeader + place;
    for (const std::uint32_t length : {0xFFFF'FFFFu, 0xFFFF'FFF8u, 0x7FFF'FFFFu, 0x2000'0000u}) {
      Bytes forged = payload;
      writeLength(forged, offset, length);
      TypeParam back;
      if (decode(forged, back)) {
        EXPECT_LE(test::unfilledSize(back), payload.size());
      }
    }
  });
}

TYPED_TEST(CodecTest, RandomBytesNeverDoHarm) {
  std::mt19937 generator(40);
  const Bytes good = encoded(test::full<TypeParam>());
  Bytes buffer(maxPayload<TypeParam>());
  TypeParam reused;
  for (int i = 0; i < 4000; ++i) {
    Bytes payload;
    if (i % 2 == 0) {
      payload.resize(generator() % (2 * good.size()));
      for (std::byte& b : payload) b = static_cast<std::byte>(generator());
      if (i % 4 == 0 && payload.size() > 1)
        payload[0] = std::byte{0}, payload[1] = static_cast<std::byte>(generator() % 2);
    } else {
      payload = good;
      for (int k = 0; k < 3; ++k) payload[generator() % payload.size()] = static_cast<std::byte>(generator());
    }
    // What is accepted is a message: it can be encoded, unless a sequence is longer than its bound.
    if (decode(payload, reused)) (void)encode(reused, std::span(buffer));
  }
  ASSERT_TRUE(decode(good, reused));
  EXPECT_EQ(reused, test::full<TypeParam>());
}

template <class... Types>
std::uint64_t hashOfPayloads(testing::Types<Types...>) {
  std::uint64_t hash = 0;
  ((hash = chainHash(chainHash(hash, encoded(test::full<Types>())), encoded(Types{}))), ...);
  return hash;
}

TEST(Codec, PayloadsAreTheSameWithEveryVersionOfTheProduct) {
  // A full and an empty message of every type. Another value here is another format on the wire and in recordings.
  EXPECT_EQ(hashOfPayloads(test::AllTypes{}), 10000127706361702053u);
}

TEST(Codec, RoomForAForgedSequenceIsBoundedByThePayload) {
  const Bytes payload = encoded(test::full<msg::PlantState>());
  constexpr std::size_t kPositionLength = kHeader + 16;  // after step and time
  Bytes forged = payload;
  writeLength(forged, kPositionLength, 0xFFFF'FFFF);
  msg::PlantState message;
  EXPECT_FALSE(decode(forged, message));
  EXPECT_LE(message.position().capacity(), payload.size());
  writeLength(forged, kPositionLength, static_cast<std::uint32_t>(payload.size() - kPositionLength - 4));
  EXPECT_FALSE(decode(forged, message)) << "as many entries as bytes are left";
  EXPECT_LE(message.position().capacity(), payload.size());
}

TEST(Codec, AMessageBeyondItsBoundsIsNotEncoded) {
  auto message = test::full<msg::PlantState>();
  for (auto* sequence : {&message.position(), &message.velocity(), &message.applied_effort()}) sequence->resize(9);
  EXPECT_TRUE(encoded(message).empty());
}

TEST(Codec, StringsAreCutAtTheirBound) {
  msg::ServiceStatus message;
  message.name(std::string(1'000, 'x'));
  msg::ServiceStatus back;
  ASSERT_TRUE(decode(encoded(message), back));
  EXPECT_EQ(std::string(back.name().c_str()), std::string(msg::MAX_NAME, 'x'));
}

TEST(Codec, AnEncapsulationThatIsNotPlainCdrIsRefused) {
  Bytes payload = encoded(test::full<msg::SimRequest>());
  msg::SimRequest message;
  for (int kind = 2; kind < 256; ++kind) {
    payload[1] = static_cast<std::byte>(kind);
    EXPECT_FALSE(decode(payload, message)) << kind;
  }
  payload[1] = std::byte{1};
  payload[0] = std::byte{7};
  EXPECT_FALSE(decode(payload, message));
}

}  // namespace
}  // namespace baton::dds
