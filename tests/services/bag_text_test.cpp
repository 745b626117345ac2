// Messages of a recording as JSON lines and as the cells of a table.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "bag/csv_columns.hpp"
#include "bag/message_text.hpp"
#include "base/error.hpp"
#include "schema/error.hpp"
#include "schema/idl_parser.hpp"
#include "support/small_recording.hpp"

namespace baton {
namespace {

constexpr auto kInfinity = std::numeric_limits<double>::infinity();

/// The line of a message of struct S.
std::string lineOf(const std::string& idl, const test::Bytes& payload, std::string* problem = nullptr) {
  const schema::TypeSet types = schema::parseIdl(idl);
  const mcap::Channel channel{.topic = "t", .metadata = {{"service", "s"}, {"writer", "w"}, {"type", "S"}}};
  const mcap::MessageView message{
      .channel = &channel, .sequence = 7, .log_time_ns = 8, .publish_time_ns = 9, .data = payload.bytes};
  std::string line;
  const std::string found = appendJsonLine(line, message, types.find("S"));
  if (problem != nullptr) *problem = found;
  return line;
}

nlohmann::json messageOf(const std::string& idl, const test::Bytes& payload) {
  return nlohmann::json::parse(lineOf(idl, payload)).at("message");
}

TEST(BagText, ALineSaysWhereAMessageComesFrom) {
  EXPECT_EQ(lineOf("struct S { long a; };", test::Bytes().number(3)),
            R"({"topic":"t","service":"s","writer":"w","sequence":7,"log_time_ns":8,"publish_time_ns":9,"type":"S",)"
            R"("message":{"a":3}})");
}

TEST(BagText, FloatingPointNumbersReadBackAsTheSame) {
  std::mt19937_64 random(11);
  std::vector<double> numbers{0.0,    -0.0,    1.0,   0.1,   1e22,  -1e-7, std::numeric_limits<double>::max(),
                              5e-324, 1.0 / 3, 1e300, 123.0, 2.5e-9};
  for (int i = 0; i < 1000; ++i) {
    const double number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  for (const double number : numbers) {
    const double back = messageOf("struct S { double a; };", test::Bytes().number(number)).at("a");
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(number));
  }
  EXPECT_NE(lineOf("struct S { double a; };", test::Bytes().number(0.1)).find("{\"a\":0.1}"), std::string::npos);
  EXPECT_NE(lineOf("struct S { float a; };", test::Bytes().number(0.1F)).find("{\"a\":0.1}"), std::string::npos);
  EXPECT_NE(lineOf("struct S { double a; };", test::Bytes().number(-0.0)).find("{\"a\":-0.0}"), std::string::npos);
}

TEST(BagText, WhatIsNotFiniteIsAString) {
  const test::Bytes payload = test::Bytes().number(std::nan("")).number(kInfinity).number(-kInfinity);
  EXPECT_EQ(messageOf("struct S { double a[3]; };", payload).at("a"), (nlohmann::json{"NaN", "Infinity", "-Infinity"}));
}

TEST(BagText, IntegersKeepAllTheirDigits) {
  const std::string line = lineOf(
      "struct S { unsigned long long a; long long b; };",
      test::Bytes().number(std::numeric_limits<std::uint64_t>::max()).number(std::numeric_limits<std::int64_t>::min()));
  EXPECT_NE(line.find("{\"a\":18446744073709551615,\"b\":-9223372036854775808}"), std::string::npos) << line;
}

TEST(BagText, EnumsAreNamesOctetsAreHexAndStringsAreQuoted) {
  test::Bytes payload;
  payload.number(1).number(9).number(std::uint32_t{2});
  payload.number(std::uint8_t{0xAB}).number(std::uint8_t{1}).text("a\"b\n\xFF").number('c').number(std::uint8_t{1});
  EXPECT_EQ(messageOf("enum E { E_A, E_B }; struct S { E a; E b; sequence<octet> c; string d; char e; boolean f; };",
                      payload),
            nlohmann::json::parse(
                "{\"a\":\"E_B\",\"b\":9,\"c\":\"ab01\",\"d\":\"a\\\"b\\n\xEF\xBF\xBD\",\"e\":\"c\",\"f\":true}"));
}

TEST(BagText, StructsUnionsAndListsNest) {
  test::Bytes payload;
  payload.number(std::uint32_t{2});
  payload.number(1).number(2.5).number(0).number(4);  // b, a
  payload.number(7);                                  // none
  EXPECT_EQ(messageOf("union U switch (long) { case 0: long a; case 1: double b; };"
                      "struct T { U u; }; struct S { sequence<T> t; U v; sequence<long, 2> w; };",
                      payload.number(std::uint32_t{0})),
            nlohmann::json::parse(R"({"t":[{"u":{"$discriminator":1,"b":2.5}},{"u":{"$discriminator":0,"a":4}}],)"
                                  R"("v":{"$discriminator":7},"w":[]})"));
}

TEST(BagText, WhatIsNoMessageOfItsTypeIsShownAsBytes) {
  std::string problem;
  const std::string line = lineOf("struct S { long a; long b; };", test::Bytes().number(3), &problem);
  EXPECT_EQ(problem, "b: expected 4 bytes, found 0");
  const nlohmann::json json = nlohmann::json::parse(line);
  EXPECT_EQ(json.at("error"), problem);
  EXPECT_EQ(json.at("data"), "0001000003000000");
  EXPECT_FALSE(json.contains("message"));
}

TEST(BagTable, HasColumnsForTheLongestMessage) {
  const schema::TypeSet types = schema::parseIdl(
      "struct T { @unit(\"m\") sequence<double> x; string name; };"
      "struct S { long step; @unit(\"N\") double f[2]; sequence<T> t; sequence<octet> raw; boolean ok; };");
  CsvColumns columns(*types.find("S"));
  test::Bytes one, two;
  one.number(1).number(0.5).number(1.5).number(std::uint32_t{1});
  one.number(std::uint32_t{2}).number(1.0).number(2.0).text("a,b").number(std::uint32_t{0}).number(std::uint8_t{1});
  two.number(2).number(-0.5).number(-1.5).number(std::uint32_t{2});
  two.number(std::uint32_t{0}).text("").number(std::uint32_t{1}).number(3.0).text("c");
  two.number(std::uint32_t{1}).number(std::uint8_t{255}).number(std::uint8_t{0});
  columns.fit(one.bytes);
  columns.fit(two.bytes);
  EXPECT_EQ(columns.finish(),
            (std::vector<std::string>{"step", "f[0] [N]", "f[1] [N]", "t[0].x[0] [m]", "t[0].x[1] [m]", "t[0].name",
                                      "t[1].x[0] [m]", "t[1].name", "raw", "ok"}));
  std::vector<std::string> cells;
  columns.fill(one.bytes, cells);
  EXPECT_EQ(cells, (std::vector<std::string>{"1", "0.5", "1.5", "1.0", "2.0", "a,b", "", "", "", "1"}));
  columns.fill(two.bytes, cells);
  EXPECT_EQ(cells, (std::vector<std::string>{"2", "-0.5", "-1.5", "", "", "", "3.0", "c", "ff", "0"}));
}

TEST(BagTable, AStructWithoutMembersHasNoColumn) {
  const schema::TypeSet types = schema::parseIdl("struct Empty {}; struct S { Empty e; long a; };");
  CsvColumns columns(*types.find("S"));
  const test::Bytes message = test::Bytes().number(3);
  columns.fit(message.bytes);
  EXPECT_EQ(columns.finish(), std::vector<std::string>{"a"});
  std::vector<std::string> cells;
  columns.fill(message.bytes, cells);
  EXPECT_EQ(cells, std::vector<std::string>{"3"});
}

TEST(BagTable, UnionsHaveTheColumnsOfAllTheirMembers) {
  const schema::TypeSet types =
      schema::parseIdl("union U switch (boolean) { case TRUE: double a; case FALSE: string b; }; struct S { U u; };");
  CsvColumns columns(*types.find("S"));
  const test::Bytes payload = test::Bytes().number(std::uint8_t{0}).text("x");
  columns.fit(payload.bytes);
  EXPECT_EQ(columns.finish(), (std::vector<std::string>{"u.$discriminator", "u.a", "u.b"}));
  std::vector<std::string> cells;
  columns.fill(payload.bytes, cells);
  EXPECT_EQ(cells, (std::vector<std::string>{"0", "", "x"}));
}

TEST(BagTable, RefusesToBecomeTooWide) {
  const schema::TypeSet types = schema::parseIdl(
      "struct S { uint8 a[20000]; }; struct T { sequence<uint8> a; }; struct U { boolean b[20000]; };");
  for (const char* name : {"S", "T", "U"}) {
    CsvColumns columns(*types.find(name));
    test::Bytes payload;
    if (name[0] == 'T') payload.number(std::uint32_t{20'000});
    payload.bytes.resize(payload.bytes.size() + 20'000);
    EXPECT_THROW(columns.fit(payload.bytes), UsageError) << name;
  }
}

TEST(BagTable, AMessageOfAnotherTypeLeavesItsCellsEmpty) {
  const schema::TypeSet types = schema::parseIdl("struct S { long a; long b; };");
  CsvColumns columns(*types.find("S"));
  (void)columns.finish();
  std::vector<std::string> cells{"left over"};
  EXPECT_THROW(columns.fill({}, cells), schema::PayloadError);
  EXPECT_EQ(cells, (std::vector<std::string>{"", ""}));
}

TEST(BagTable, QuotesFieldsThatNeedIt) {
  EXPECT_EQ(csvField("plain text"), "plain text");
  EXPECT_EQ(csvField("a,b"), "\"a,b\"");
  EXPECT_EQ(csvField("say \"it\""), "\"say \"\"it\"\"\"");
  EXPECT_EQ(csvField("two\nlines"), "\"two\nlines\"");
}

}  // namespace
}  // namespace baton
