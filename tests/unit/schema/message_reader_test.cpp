/// Payloads along their types: every type of idl/ byte for byte, both byte orders, and what cannot be a message.
#include "schema/message_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "msg/idl_text.hpp"
#include "schema/error.hpp"
#include "schema/idl_parser.hpp"
#include "unit/dds/full_messages.hpp"
#include "unit/schema/decoded.hpp"

namespace baton::schema {
namespace {

using Payload = std::vector<std::byte>;

/// Puts items into bytes again: CDR the other way round, on its own.
class Rewriter {
 public:
  explicit Rewriter(bool is_little_endian) : is_little_endian_(is_little_endian) {
    bytes = {std::byte{0}, std::byte{is_little_endian}, std::byte{0}, std::byte{0}};
  }
  void add(const Item& item) {
    if (item.what == Item::What::kBegin && item.type->kind == Kind::kSequence) number(item.count);
    if (item.what != Item::What::kValue) return;
    const Value& value = item.value;
    switch (item.type->kind) {
      case Kind::kBoolean: number(static_cast<std::uint8_t>(std::get<bool>(value))); break;
      case Kind::kOctet:
      case Kind::kUint8: number(static_cast<std::uint8_t>(std::get<std::uint64_t>(value))); break;
      case Kind::kUint16: number(static_cast<std::uint16_t>(std::get<std::uint64_t>(value))); break;
      case Kind::kUint32: number(static_cast<std::uint32_t>(std::get<std::uint64_t>(value))); break;
      case Kind::kUint64: number(std::get<std::uint64_t>(value)); break;
      case Kind::kInt8: number(static_cast<std::int8_t>(std::get<std::int64_t>(value))); break;
      case Kind::kInt16: number(static_cast<std::int16_t>(std::get<std::int64_t>(value))); break;
      case Kind::kEnum:
      case Kind::kInt32: number(static_cast<std::int32_t>(std::get<std::int64_t>(value))); break;
      case Kind::kInt64: number(std::get<std::int64_t>(value)); break;
      case Kind::kFloat: number(std::get<float>(value)); break;
      case Kind::kDouble: number(std::get<double>(value)); break;
      case Kind::kChar: number(std::get<std::string_view>(value).at(0)); break;
      case Kind::kString: {
        const std::string text(std::get<std::string_view>(value));
        number(static_cast<std::uint32_t>(text.size() + 1));
        raw(std::as_bytes(std::span(text.c_str(), text.size() + 1)));
        break;
      }
      case Kind::kSequence: number(static_cast<std::uint32_t>(std::get<Bytes>(value).size())); [[fallthrough]];
      default: raw(std::get<Bytes>(value)); break;
    }
  }
  template <class Number>
  void number(Number value) {
    while ((bytes.size() - 4) % sizeof value != 0) bytes.push_back(std::byte{0});
    std::array<std::byte, sizeof value> parts{};
    std::memcpy(parts.data(), &value, sizeof value);
    if (!is_little_endian_) std::ranges::reverse(parts);
    raw(parts);
  }
  void raw(Bytes more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

  Payload bytes;

 private:
  bool is_little_endian_;
};

template <class T>
Payload encoded(const T& message, bool is_little_endian) {
  Payload buffer(dds::maxPayload<T>());
  if (is_little_endian) {
    buffer.resize(dds::encode(message, std::span(buffer)).size());
    return buffer;
  }
  msg::FastBuffer fast(reinterpret_cast<char*>(buffer.data()), buffer.size());
  msg::PlainCdr cdr(fast, msg::PlainCdr::BIG_ENDIANNESS);
  cdr.serialize_encapsulation();
  cdr << message;
  buffer.resize(cdr.length());
  return buffer;
}

/// Reads to the end.
std::vector<Item> itemsOf(const Type& type, Bytes payload) {
  std::vector<Item> items;
  MessageReader reader(type, payload);
  for (Item item; reader.next(item);) items.push_back(item);
  return items;
}

/// The message of the error that reading ends with; empty when it ends well.
std::string errorOf(const Type& type, Bytes payload) {
  try {
    (void)itemsOf(type, payload);
    return "";
  } catch (const PayloadError& error) {
    return error.what();
  }
}

TypeSet withType(std::string_view type_name) {
  for (const msg::IdlText& one : msg::allIdlTexts()) {
    if (one.type_name == type_name) return parseIdl(one.text);
  }
  throw std::runtime_error("no such type");
}

/// "baton::msg::PlantState"
template <class T>
std::string nameOf() {
  return testing::internal::GetTypeName<T>();
}

template <class T>
class EveryType : public testing::Test {};
TYPED_TEST_SUITE(EveryType, test::AllTypes);

TYPED_TEST(EveryType, ComesOutAsItWentIn) {
  const std::string name = nameOf<TypeParam>();
  const TypeSet types = withType(name);
  const Type& type = *types.find(name);
  for (const bool is_little_endian : {true, false}) {
    for (const auto& message : {test::full<TypeParam>(), TypeParam{}}) {
      const Payload payload = encoded(message, is_little_endian);
      Rewriter again(is_little_endian);
      for (const Item& item : itemsOf(type, payload)) again.add(item);
      again.bytes.resize(std::max(again.bytes.size(), payload.size()));  // filled up
      EXPECT_EQ(again.bytes, payload) << name;
    }
  }
}

TYPED_TEST(EveryType, IsRefusedWhenItEndsTooEarly) {
  const std::string name = nameOf<TypeParam>();
  const TypeSet types = withType(name);
  const Type& type = *types.find(name);
  const Payload payload = encoded(test::full<TypeParam>(), true);
  const std::size_t unfilled = test::unfilledSize(test::full<TypeParam>());
  const std::size_t stride = payload.size() > 2000 ? 7 : 1;
  for (std::size_t size = 0; size < unfilled; size += stride) {
    EXPECT_NE(errorOf(type, std::span(payload).first(size)), "") << name << " of " << size;
  }
}

TYPED_TEST(EveryType, SurvivesAnyDamage) {
  const std::string name = nameOf<TypeParam>();
  const TypeSet types = withType(name);
  const Type& type = *types.find(name);
  const Payload payload = encoded(test::full<TypeParam>(), true);
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Payload damaged = payload;
    for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    try {
      const std::vector<Item> items = itemsOf(type, damaged);
      EXPECT_LE(items.size(), damaged.size() * 3);  // begin, end and a value for each byte at most
    } catch (const PayloadError&) {
    }
  }
}

TEST(MessageReader, SaysWhereItIsAndWhatIsThere) {
  const TypeSet types = withType("baton::msg::PlantState");
  const Type& type = *types.find("baton::msg::PlantState");
  const Payload payload = encoded(test::full<msg::PlantState>(), true);
  MessageReader reader(type, payload);
  std::map<std::string, Value> values;
  for (Item item; reader.next(item);) {
    if (item.what == Item::What::kValue) values[reader.path()] = item.value;
  }
  EXPECT_EQ(std::get<std::uint64_t>(values.at("step")), test::kId);
  EXPECT_EQ(std::get<std::int64_t>(values.at("time_ns")), test::kTime);
  EXPECT_EQ(std::get<double>(values.at("position[7]")), -1.0 / 3.0);
  EXPECT_EQ(std::get<double>(values.at("tip_position[1]")), -2e300);
  EXPECT_EQ(std::get<double>(values.at("tip_orientation.x")), -0.5);
  EXPECT_EQ(std::get<std::string_view>(values.at("holder")), test::fullName());
  EXPECT_EQ(std::get<bool>(values.at("checkpoint")), true);
  EXPECT_EQ(values.size(), 2U + 3 * 8 + 3 + 4 + 3 + 3 + 3);
}

TEST(MessageReader, UnionsChooseTheirMember) {
  const TypeSet types = parseIdl(
      "enum Mode { MODE_A, MODE_B };"
      "union U switch (Mode) { case MODE_A: long a; case MODE_B: double b[2]; };"
      "union V switch (boolean) { case TRUE: string c; };"
      "union W switch (uint8) { case 1: octet d; default: octet e; };"
      "struct S { U u[2]; V v; V w; W x; W y; };");
  Rewriter out(true);
  out.number(std::int32_t{1});
  out.number(1.5);
  out.number(2.5);
  out.number(std::int32_t{0});
  out.number(std::int32_t{-7});
  out.number(std::uint8_t{1});
  out.number(std::uint32_t{2});
  out.raw(std::as_bytes(std::span("z")));
  out.number(std::uint8_t{0});
  out.number(std::uint8_t{1});
  out.number(std::uint8_t{11});
  out.number(std::uint8_t{200});
  out.number(std::uint8_t{12});
  MessageReader reader(*types.find("S"), out.bytes);
  std::vector<std::string> paths;
  for (Item item; reader.next(item);) {
    if (item.what == Item::What::kValue) paths.push_back(reader.path());
  }
  EXPECT_EQ(paths, (std::vector<std::string>{"u[0].$discriminator", "u[0].b[0]", "u[0].b[1]", "u[1].$discriminator",
                                             "u[1].a", "v.$discriminator", "v.c", "w.$discriminator",
                                             "x.$discriminator", "x.d", "y.$discriminator", "y.e"}));
}

TEST(MessageReader, OctetsComeWhole) {
  const TypeSet types = parseIdl("struct S { octet a[3]; sequence<octet> b; octet c; uint8 d[2]; };");
  Rewriter out(true);
  const std::array<std::byte, 3> three{std::byte{1}, std::byte{2}, std::byte{3}};
  out.raw(three);
  out.number(std::uint32_t{3});
  out.raw(three);
  for (const std::uint8_t one : {9, 7, 8}) out.number(one);
  const std::vector<Item> items = itemsOf(*types.find("S"), out.bytes);
  EXPECT_TRUE(std::ranges::equal(std::get<Bytes>(items[1].value), three));
  EXPECT_TRUE(std::ranges::equal(std::get<Bytes>(items[2].value), three));
  EXPECT_EQ(std::get<std::uint64_t>(items[3].value), 9U);
  EXPECT_EQ(items[4].count, 2U);
}

TEST(MessageReader, RefusesOtherEncodings) {
  const TypeSet types = parseIdl("struct S { long a; };");
  for (const int encoding : {2, 3, 6, 7, 8, 9, 10, 11, 256}) {
    const Payload payload{static_cast<std::byte>(encoding >> 8),
                          static_cast<std::byte>(encoding),
                          std::byte{0},
                          std::byte{0},
                          std::byte{1},
                          std::byte{0},
                          std::byte{0},
                          std::byte{0}};
    const std::string error = errorOf(*types.find("S"), payload);
    EXPECT_NE(error.find("plain CDR"), std::string::npos) << encoding;
    const bool is_list = encoding == 2 || encoding == 3 || encoding == 10 || encoding == 11;
    EXPECT_EQ(error.find("parameter list") != std::string::npos, is_list) << error;
    EXPECT_EQ(error.find("XCDR2") != std::string::npos, encoding >= 6 && encoding <= 11) << error;
    EXPECT_EQ(error.find("delimited") != std::string::npos, encoding == 8 || encoding == 9) << error;
  }
}

TEST(MessageReader, ReadsAppendableTypesOfOtherVendorsInEitherByteOrder) {
  const TypeSet types = parseIdl(
      "@extensibility(APPENDABLE) struct Inner { octet a; double b; };"
      "enum E { @value(-2) LOW, @value(7) HIGH };"
      "@extensibility(FINAL) struct S { @key long n; sequence<Inner> inner; E e; };");
  for (const bool is_little_endian : {true, false}) {
    Rewriter out(is_little_endian);
    out.number(std::int32_t{3});
    out.number(std::uint32_t{1});
    out.number(std::uint8_t{9});
    out.number(2.5);
    out.number(std::int32_t{-2});
    MessageReader reader(*types.find("S"), out.bytes);
    std::map<std::string, Value> values;
    for (Item item; reader.next(item);) {
      if (item.what == Item::What::kValue) values[reader.path()] = item.value;
    }
    EXPECT_EQ(std::get<std::int64_t>(values.at("n")), 3);
    EXPECT_EQ(std::get<double>(values.at("inner[0].b")), 2.5);
    EXPECT_EQ(std::get<std::int64_t>(values.at("e")), -2);
    EXPECT_EQ(enumeratorName(*types.find("S")->members[2].type, -2), "LOW");
  }
}

TEST(MessageReader, RefusesWhatNoMessageCanBe) {
  const auto error = [](const std::string& member, const auto& write) {
    const TypeSet types = parseIdl("struct S { " + member + "; };");
    Rewriter out(true);
    write(out);
    return errorOf(*types.find("S"), out.bytes);
  };
  EXPECT_EQ(error("boolean a", [](Rewriter& out) { out.number(std::uint8_t{2}); }),
            "a: expected a boolean, 0 or 1, found 2");
  EXPECT_EQ(error("sequence<double> a", [](Rewriter& out) { out.number(std::uint32_t{0xFFFF'FFFF}); }),
            "a: expected a length that fits into 0 bytes, found 4294967295");
  EXPECT_EQ(error("sequence<octet, 2> a", [](Rewriter& out) { out.number(std::uint32_t{3}); }),
            "a: expected a length of at most 2, found 3");
  EXPECT_EQ(error("string<2> a", [](Rewriter& out) { out.number(std::uint32_t{4}); }),
            "a: expected a length of at most 3, found 4");
  EXPECT_EQ(error("string a", [](Rewriter& out) { out.number(std::uint32_t{1}), out.number('x'); }),
            "a: expected a string that ends with a zero, found 120");
  EXPECT_EQ(error("octet a", [](Rewriter& out) { out.number(1.0); }),
            "expected the end of the message, found 7 more bytes");
  EXPECT_EQ(error("octet a", [](Rewriter& out) { out.number(1); }), "");
  EXPECT_EQ(error("string a", [](Rewriter& out) { out.number(0); }), "");  // an empty one without its end
  EXPECT_EQ(error("long a[2]", [](Rewriter& out) { out.number(1); }), "a[1]: expected 4 bytes, found 0");
}

TEST(MessageReader, AStructWithoutMembersTakesNoBytes) {
  const std::string empty = "struct Empty {}; ";
  EXPECT_EQ(test::decoded("struct S {};", {}), "{}");
  EXPECT_EQ(test::decoded("struct S { };", {0, 0, 0}), "{}") << "filled up";
  EXPECT_EQ(test::decoded("struct S {};", {1, 0, 0, 0}), "expected the end of the message, found 4 more bytes");
  EXPECT_EQ(test::decoded(empty + "struct S { Empty a; octet b; Empty c[2]; };", {7}), "{} b=7 {} {}");
  EXPECT_EQ(test::decoded(empty + "struct S : Empty { octet b; };", {7}), "b=7");
  EXPECT_EQ(test::decoded(empty + "union S switch (octet) { case 1: Empty a; };", {1}), "$discriminator=1 {}");
  EXPECT_EQ(test::decoded(empty + "struct S { sequence<Empty> a; octet b; };", {2, 0, 0, 0, 7}), "{} {} b=7");
}

TEST(MessageReader, WhatTakesNoBytesHasALimit) {
  const std::string empty = "struct Empty {}; struct Two { Empty a; Empty b; }; ";
  const std::string refused = ": expected at most 1000 structs without members, found more";
  EXPECT_EQ(test::decoded(empty + "struct S { Empty a[4000000000]; };", {}), "a[1000]" + refused);
  EXPECT_EQ(test::decoded(empty + "struct S { sequence<Two> a; };", {0xFF, 0xFF, 0xFF, 0xFF}), "a[500].a" + refused);
  EXPECT_EQ(test::decoded(empty + "struct S { Two a[500]; };", {}).size(), 2999U);
}

TEST(MessageReader, ReadsATypeThatIsNoStruct) {
  const TypeSet types = parseIdl("typedef double Number;");
  Rewriter out(false);
  out.number(0.1);
  const std::vector<Item> items = itemsOf(*types.find("Number"), out.bytes);
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(std::get<double>(items[0].value), 0.1);
}

}  // namespace
}  // namespace baton::schema
