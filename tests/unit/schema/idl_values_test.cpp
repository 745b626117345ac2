/// Constant expressions of IDL texts, by what they make of a type.
#include "schema/idl_values.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "schema/limits.hpp"
#include "unit/schema/decoded.hpp"

namespace baton::schema {
namespace {

using test::decoded;

/// Elements of the array that has this size; 0 when it is refused.
std::uint64_t size(const std::string& expression, const std::string& before = "") {
  const TypeSet types = parseIdl(before + " struct S { octet a[" + expression + "]; };");
  const Type* type = types.find("S");
  return type == nullptr ? 0 : type->members.front().type->bound;
}

/// What is wrong with it.
std::string problemOf(const std::string& text) {
  const TypeSet types = parseIdl(text);
  return types.problems().empty() ? "" : types.problems().front().text;
}

TEST(IdlValues, NumbersAreDecimalHexadecimalOrOctal) {
  for (const auto& [text, value] :
       {std::pair("12", 12U), {"0x1F", 31U}, {"0XfE", 254U}, {"0xE+1", 15U}, {"017", 15U}, {"+3", 3U}}) {
    EXPECT_EQ(size(text), value) << text;
  }
  for (const char* text : {"0x", "08", "0xG", "1f", "1.0", "1e1", "'a'", "\"1\"", "TRUE", ""}) {
    EXPECT_EQ(size(text), 0U) << text;
  }
}

TEST(IdlValues, OperatorsHaveTheirRanks) {
  for (const auto& [text, value] : {std::pair("1 + 2 * 3", 7U),
                                    {"(1 + 2) * 3", 9U},
                                    {"20 - 4 - 3", 13U},
                                    {"100 / 10 / 2", 5U},
                                    {"17 % 5", 2U},
                                    {"1 << 3 + 1", 16U},
                                    {"256 >> 2 >> 1", 32U},
                                    {"1 | 6 & 3", 3U},
                                    {"1 | 7 ^ 2", 5U},
                                    {"12 ^ 10 & 6", 14U},
                                    {"-2 + 5", 3U},
                                    {"2 * -3 + 7", 1U},
                                    {"-(2 - 5)", 3U},
                                    {"~(-4)", 3U},
                                    {"((((5))))", 5U}}) {
    EXPECT_EQ(size(text), value) << text;
  }
}

TEST(IdlValues, ConstantsOfEveryScopeAreNumbers) {
  const std::string before =
      "const long N = 2; module m { const octet N = N * 2 + 1; module n { const unsigned short M = ::m::N + ::N; }; };";
  EXPECT_EQ(size("N", before), 2U);
  EXPECT_EQ(size("m::N - N", before), 3U);
  EXPECT_EQ(size("::m::n::M << 1", before), 14U);
  EXPECT_EQ(size("m::M", before), 0U);
  EXPECT_EQ(size("F", "const double F = 2;"), 0U);
  EXPECT_EQ(size("A", "enum E { X, A };"), 0U);
}

TEST(IdlValues, BoundsLabelsAndEnumeratorsAreExpressions) {
  const std::string text =
      "const long N = 0x2; enum E { A = 1 << 3, @value(N * 5) B };"
      "union U switch (long) { case N + 1: octet a; case -N: octet b; };"
      "union V switch (E) { case B: octet c; };"
      "struct S { sequence<sequence<octet, 1 + 1>> s; string<(8 >> 1)> t; U u; V v; };";
  EXPECT_EQ(decoded(text, {1, 0, 0, 0,    2,    0,    0,    0, 7, 8, 0, 0,  2, 0, 0, 0, 'x',
                           0, 0, 0, 0xFE, 0xFF, 0xFF, 0xFF, 5, 0, 0, 0, 10, 0, 0, 0, 6}),
            "s[0]=2 octets t=x u.$discriminator=-2 u.b=5 v.$discriminator=10 v.c=6");
  EXPECT_EQ(decoded("struct S { sequence<octet, 1 << 1> a; };", {3, 0, 0, 0, 1, 2, 3}),
            "a: expected a length of at most 2, found 3");
}

TEST(IdlValues, CharactersAreLabelsAndConstants) {
  const std::string text =
      "const char TAB = '\\t';"
      "union U switch (char) { case 'a': octet a; case TAB: case '\\n': octet b; case '\\x41': octet c;"
      "  case '\\\\': case '\\'': octet d; case '\\101': default: octet e; };"
      "struct S { U u; };";
  const auto chosen = [&](int code) {
    const std::string all = decoded(text, {code, 9});
    return all.substr(all.find(' ') + 1);
  };
  EXPECT_NE(chosen('a'), "u.a=9") << "'\\x41' and '\\101' are the same";
  const std::string once = std::string(text).replace(text.find("case '\\101': "), 13, "");
  for (const auto& [code, member] : {std::pair('a', "u.a=9"),
                                     {'\t', "u.b=9"},
                                     {'\n', "u.b=9"},
                                     {'A', "u.c=9"},
                                     {'\\', "u.d=9"},
                                     {'\'', "u.d=9"},
                                     {'z', "u.e=9"},
                                     {'\xE9', "u.e=9"}}) {
    const std::string all = decoded(once, {code, 9});
    EXPECT_EQ(all.substr(all.rfind(' ') + 1), member) << code;
  }
  EXPECT_EQ(decoded("union S switch (char) { case '\\xe9': octet a; };", {0xE9, 4}), "$discriminator=\xE9 a=4");
  EXPECT_EQ(decoded("union S switch (octet) { case 0xE9: octet a; };", {0xE9, 4}), "$discriminator=233 a=4");
  EXPECT_EQ(decoded("const wchar B = '\\u20ac'; union S switch (wchar) { case L'a': octet a; case B: octet b; };",
                    {0xAC, 0x20, 4}),
            "$discriminator=8364 b=4");
  for (const char* label : {"''", "L'a'", "'\\u20ac'", "L", "'ab'", "'\\q'", "'\\x100'", "'\\400'", "\"a\"", "97"}) {
    EXPECT_NE(problemOf(std::string("union U switch (char) { case ") + label + ": octet a; };"), "") << label;
  }
}

TEST(IdlValues, ConstantsHaveTheNumbersOfTheirTypes) {
  for (const char* constant :
       {"octet N = 0xFF", "octet N = ~0 & 255", "unsigned short N = ~0", "uint64 N = 0xFFFFFFFFFFFFFFFF",
        "uint64 N = ~0", "int64 N = -9223372036854775808", "long N = ~0x7FFFFFFF", "double N = 2.0 * 3 - (1e3 / F)",
        "float N = 1000000000 * 1000000000 * 1000000000 * F", "char N = 'x'", "boolean N = FALSE",
        "string N = \"a\" \"b\""}) {
    EXPECT_EQ(problemOf("const double F = 0.5; const " + std::string(constant) + ";"), "") << constant;
  }
  for (const char* constant : {"octet N = 256", "octet N = -1", "unsigned short N = ~0 + 1", "uint64 N = ~0 + 1",
                               "int64 N = 0x8000000000000000", "long N = 0x80000000", "long N = 1.5", "double N = 1 +",
                               "char N = 120", "boolean N = 1", "string N = 'a'", "double N = \"1\""}) {
    EXPECT_NE(problemOf("const " + std::string(constant) + ";"), "") << constant;
  }
  EXPECT_EQ(size("N >> 30", "const unsigned long N = ~0;"), 3U);
  EXPECT_EQ(decoded("union S switch (uint64) { case ~0: octet a; default: long b; };",
                    {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 3}),
            "$discriminator=18446744073709551615 a=3");
}

TEST(IdlValues, WhatIsNoSizeIsNamedWithItsLine) {
  const std::string size_wanted = "a whole number from 1 to 4294967295";
  const auto found = [](const std::string& expression) {
    return problemOf("struct S {\n octet a[" + expression + "]; };");
  };
  EXPECT_EQ(found("1 - 1"), "line 2: expected " + size_wanted + ", found 0");
  EXPECT_EQ(found("2 * -3"), "line 2: expected " + size_wanted + ", found -6");
  EXPECT_EQ(found("1 << 32"), "line 2: expected " + size_wanted + ", found 4294967296");
  EXPECT_EQ(found("8 / (2 - 2)"), "line 2: expected a divisor that is not 0, found 0");
  EXPECT_EQ(found("8 % 0"), "line 2: expected a divisor that is not 0, found 0");
  EXPECT_EQ(found("1 << 64"), "line 2: expected a shift by 0 to 63 bits, found 64");
  EXPECT_EQ(found("1 << -1"), "line 2: expected a shift by 0 to 63 bits, found -1");
  EXPECT_EQ(found("-8 >> 1"), "line 2: expected a number to shift that is not negative, found -8");
  const std::string beyond = "line 2: expected " + size_wanted + ", found a result beyond 64 bits";
  EXPECT_EQ(found("0xFFFFFFFFFFFFFFFF * 0xFFFFFFFFFFFFFFFF / 0xFFFFFFFFFFFFFFFF"), beyond);
  EXPECT_EQ(found("(0xFFFFFFFFFFFFFFFF + 1) >> 60"), beyond);
  EXPECT_EQ(found("(0xFFFFFFFFFFFFFFFF << 63) >> 63"), beyond);
  EXPECT_EQ(found("-0xFFFFFFFFFFFFFFFF"), beyond);
  EXPECT_EQ(found("~0xFFFFFFFFFFFFFFFF"), beyond);
  EXPECT_EQ(found("0x10000000000000000"), "line 2: expected " + size_wanted + ", found '0x10000000000000000'");
  EXPECT_EQ(found("M + 1"), "line 2: expected " + size_wanted + ", found 'M'");
  EXPECT_EQ(found("(1"), "line 2: expected ')', found ']'");
  EXPECT_EQ(found("2 *"), "line 2: expected " + size_wanted + ", found ']'");
  EXPECT_EQ(found(std::string(kMaxDepth, '(') + "2" + std::string(kMaxDepth, ')')), "");
  EXPECT_EQ(found(std::string(100'000, '(')), "line 2: expected at most 32 parentheses within each other, found more");
}

}  // namespace
}  // namespace baton::schema
