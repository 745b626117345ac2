/// IDL texts to types, and what is refused with its line.
#include "schema/idl_parser.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "msg/idl_text.hpp"
#include "schema/error.hpp"
#include "schema/limits.hpp"
#include "unit/schema/decoded.hpp"

namespace baton::schema {
namespace {

using test::decoded;

/// What is wrong with the text, or with its first definition that cannot be used; empty for a good text.
std::string errorOf(const std::string& text) {
  try {
    const TypeSet types = parseIdl(text);
    return types.problems().empty() ? "" : types.problems().front().text;
  } catch (const IdlError& error) {
    return error.what();
  }
}

/// The type of the only member `m` of struct S.
const Type& memberType(const TypeSet& types) { return *types.find("S")->members.front().type; }

std::string inModules(unsigned count, const std::string& text) {
  std::string begin, end;
  for (unsigned i = 0; i < count; ++i) {
    begin += "module m" + std::to_string(i) + " {";
    end += "};";
  }
  return begin + text + end;
}

TEST(IdlParser, KnowsEveryTypeOfTheIdl) {
  for (const msg::IdlText& one : msg::allIdlTexts()) {
    const TypeSet types = parseIdl(one.text);
    const Type* type = types.find(one.type_name);
    ASSERT_NE(type, nullptr) << one.type_name;
    EXPECT_EQ(type->kind, Kind::kStruct);
    EXPECT_EQ(type->name, one.type_name);
  }
}

TEST(IdlParser, KeepsNamesUnitsAndBounds) {
  for (const msg::IdlText& one : msg::allIdlTexts()) {
    if (one.type_name != "baton::msg::PlantState") continue;
    const TypeSet types = parseIdl(one.text);
    const Type& state = *types.find(one.type_name);
    ASSERT_EQ(state.members.size(), 12U);
    EXPECT_EQ(state.members[0].name, "step");
    EXPECT_EQ(state.members[0].type->kind, Kind::kUint64);
    EXPECT_EQ(state.members[0].unit, "");
    EXPECT_EQ(state.members[1].unit, "ns");
    EXPECT_EQ(state.members[2].type->kind, Kind::kSequence);
    EXPECT_EQ(state.members[2].type->bound, 8U);
    EXPECT_EQ(state.members[5].name, "tip_position");
    EXPECT_EQ(state.members[5].type->kind, Kind::kArray);
    EXPECT_EQ(state.members[5].type->bound, 3U);
    EXPECT_EQ(state.members[5].type->element->kind, Kind::kDouble);
    EXPECT_EQ(state.members[5].unit, "m");
    EXPECT_EQ(state.members[6].type, types.find("baton::msg::Quaternion"));
    EXPECT_EQ(state.members[9].type->kind, Kind::kString);
    EXPECT_EQ(state.members[9].type->bound, 32U);
  }
}

TEST(IdlParser, ReadsEveryPrimitive) {
  const std::pair<const char*, Kind> primitives[]{
      {"boolean", Kind::kBoolean}, {"octet", Kind::kOctet},
      {"char", Kind::kChar},       {"wchar", Kind::kWideChar},
      {"int8", Kind::kInt8},       {"uint8", Kind::kUint8},
      {"int16", Kind::kInt16},     {"short", Kind::kInt16},
      {"uint16", Kind::kUint16},   {"unsigned short", Kind::kUint16},
      {"int32", Kind::kInt32},     {"long", Kind::kInt32},
      {"uint32", Kind::kUint32},   {"unsigned long", Kind::kUint32},
      {"int64", Kind::kInt64},     {"long long", Kind::kInt64},
      {"uint64", Kind::kUint64},   {"unsigned long long", Kind::kUint64},
      {"float", Kind::kFloat},     {"double", Kind::kDouble},
      {"string", Kind::kString},
  };
  for (const auto& [words, kind] : primitives) {
    EXPECT_EQ(memberType(parseIdl("struct S { " + std::string(words) + " m; };")).kind, kind) << words;
  }
}

TEST(IdlParser, ArraysOfManyDimensionsHaveTheFirstIndexOutside) {
  const TypeSet types = parseIdl("const short N = 3; struct S { double m[N][4], n; };");
  const Type& rows = memberType(types);
  EXPECT_EQ(rows.kind, Kind::kArray);
  EXPECT_EQ(rows.bound, 3U);
  EXPECT_EQ(rows.element->bound, 4U);
  EXPECT_EQ(rows.element->element->kind, Kind::kDouble);
  EXPECT_EQ(rows.least_bytes, 96U);
  EXPECT_EQ(types.find("S")->members[1].type->kind, Kind::kDouble);
}

TEST(IdlParser, AStructBeginsWithTheMembersOfItsBase) {
  const std::string text =
      "module m { struct A { @key octet id; @unit(\"m\") double x; }; typedef A Base; };"
      "struct B : m::Base { octet b[2]; }; @final struct S : ::B { short c; };";
  EXPECT_EQ(decoded(text, {5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F, 7, 8, 9, 0}),
            "id=5 x=1 b=2 octets c=9");
  const TypeSet types = parseIdl(text);
  const Type& s = *types.find("S");
  EXPECT_TRUE(s.members[0].is_key);
  EXPECT_EQ(s.members[1].unit, "m");
  EXPECT_EQ(s.least_bytes, 13U);
  EXPECT_EQ(decoded("@mutable struct A { long a; }; struct S : A { long b; };", {}).substr(0, 31),
            "A: line 1: expected a final or ");
  EXPECT_EQ(errorOf("enum E { X };\nstruct S : E { long b; };"),
            "line 2: expected a struct to inherit from, found another type");
}

TEST(IdlParser, TypedefsAreTheirTypes) {
  const TypeSet types = parseIdl("typedef double Row[2]; typedef sequence<Row, 5> Rows; struct S { Rows m; };");
  EXPECT_EQ(memberType(types).kind, Kind::kSequence);
  EXPECT_EQ(memberType(types).bound, 5U);
  EXPECT_EQ(memberType(types).element->bound, 2U);
  EXPECT_EQ(types.find("Rows"), &memberType(types));
}

TEST(IdlParser, ATypedefMayDefineItsType) {
  const std::string text =
      "typedef struct Point { octet x; octet y; } Points[2], *P;"
      "module m { typedef struct A { octet x; } B, Pair[2]; typedef enum E { X, Y } F;"
      "  typedef union U switch (octet) { case 1: B b; } V; };"
      "struct S { m::A a; m::Pair b; m::F f; m::V v; };";
  EXPECT_EQ(decoded(text, {1, 2, 3, 0, 1, 0, 0, 0, 1, 5}), "a.x=1 b[0].x=2 b[1].x=3 f=1 v.$discriminator=1 v.b.x=5");
  const TypeSet types = parseIdl(text);
  EXPECT_EQ(types.find("m::B"), types.find("m::A"));
  EXPECT_EQ(types.find("Points"), nullptr);
  EXPECT_EQ(types.problemOf("Point")->text, types.problemOf("Points")->text) << "one definition, one problem";
  EXPECT_EQ(errorOf("typedef struct A B;"), "line 1: expected '{', found 'B'");
  EXPECT_EQ(errorOf("typedef struct A;"), "line 1: expected '{', found ';'");
  EXPECT_EQ(errorOf("@bit_bound(8) typedef enum E { X } F;"),
            "line 1: expected an enum of four bytes, found @bit_bound(8), which is not supported");
}

TEST(IdlParser, NamesAreLookedForFromTheInsideOut) {
  const TypeSet types = parseIdl(
      "struct T { long a; };"
      "module m { struct T { double a; };"
      "  module n { struct S { T inner; ::T outer; m::T named; }; }; };");
  const Type& s = *types.find("m::n::S");
  EXPECT_EQ(s.members[0].type, types.find("m::T"));
  EXPECT_EQ(s.members[1].type, types.find("T"));
  EXPECT_EQ(s.members[2].type, types.find("m::T"));
}

TEST(IdlParser, ReadsUnionsOnEnumsBooleansAndIntegers) {
  const TypeSet types = parseIdl(
      "enum Mode { MODE_IDLE, MODE_RUN };"
      "@final union U switch (Mode) { case MODE_IDLE: long a; case Mode::MODE_RUN: default: @unit(\"m\") double b[2]; "
      "};"
      "union V switch (boolean) { case TRUE: long a; };"
      "const long FIVE = 5;"
      "union W switch (long) { case -1: case FIVE: long a; case 7: string b; };");
  const Type& u = *types.find("U");
  EXPECT_EQ(u.members[0].name, kDiscriminator);
  EXPECT_EQ(chosenMember(u, 0)->name, "a");
  EXPECT_EQ(chosenMember(u, 1)->name, "b");
  EXPECT_EQ(chosenMember(u, 1)->unit, "m");
  EXPECT_EQ(chosenMember(u, 9)->name, "b");
  EXPECT_EQ(enumeratorName(*u.members[0].type, 1), "MODE_RUN");
  EXPECT_EQ(enumeratorName(*u.members[0].type, 2), "");
  EXPECT_EQ(enumeratorName(*u.members[0].type, -1), "");
  EXPECT_EQ(chosenMember(*types.find("V"), 1)->name, "a");
  EXPECT_EQ(chosenMember(*types.find("V"), 0), nullptr);
  const Type& w = *types.find("W");
  EXPECT_EQ(chosenMember(w, -1)->name, "a");
  EXPECT_EQ(chosenMember(w, 5)->name, "a");
  EXPECT_EQ(chosenMember(w, 7)->name, "b");
}

TEST(IdlParser, SkipsCommentsAndAnnotationsThatChangeNothing) {
  const TypeSet types = parseIdl(
      "// a comment\n/* another,\n over lines */\n@final @topic struct S {\n"
      "  @key @id(3) long m; // behind\n  @range(min = -1.5, max = 2e+3) @default(7) @unit(\"m/s^2\") double n;\n};");
  EXPECT_TRUE(types.find("S")->members[0].is_key);
  EXPECT_EQ(types.find("S")->members[1].unit, "m/s^2");
  const TypeSet constants = parseIdl("const float F = -1.5e-3; const string T = \"a\" \"b\"; const boolean B = TRUE;");
  EXPECT_TRUE(constants.names().empty());
}

TEST(IdlParser, FinalAndAppendableTypesAreTheSame) {
  for (const char* mark :
       {"@final", "@appendable", "@extensibility(FINAL)", "@extensibility(APPENDABLE)", "@extensibility(value = FINAL)",
        "@Extensibility(EXTENSIBLE_EXTENSIBILITY)", "@Extensibility(FINAL_EXTENSIBILITY)", "@dds::final"}) {
    for (const char* kind : {"struct S { double m; };", "enum E { A }; struct S { E m; };",
                             "union U switch (long) { case 1: long a; }; struct S { U m; };"}) {
      EXPECT_EQ(errorOf(std::string(mark) + " " + kind), "") << mark;
    }
  }
  EXPECT_NE(errorOf("@extensibility(OTHER) struct S { long a; };"), "");
  EXPECT_NE(errorOf("@extensibility struct S { long a; };"), "");
}

TEST(IdlParser, AnnotationsOfOthersAreSkipped) {
  const TypeSet types = parseIdl(
      "@annotation mine { string text default \"a }\"; enum K { X, Y }; };\n"
      "@verbatim(language = \"c++\", placement = BEFORE_DECLARATION, text = \"#include <a>\\n\" \"// \\\"x) ;\")\n"
      "@data_representation(XCDR1 | XCDR2) @default_nested @autoid(HASH) @mine(text = \"b\") @RTI::transfer(MODE)\n"
      "@nested(FALSE) @topic(name = \"t\", platform = \"*\") @bit_bound(32) @ignore_literal_names\n"
      "struct S {\n"
      "  @Key @ID(0x10) @must_understand @hashid(\"m\") double m;\n"
      "  @default((1 << 3) * 2) @min(-1) @external @try_construct(USE_DEFAULT) long n;\n"
      "  @default('\\'') char c;\n"
      "};\n"
      "@final union U switch (@key long) { case 1: @id(7) long a; };");
  const Type& s = *types.find("S");
  ASSERT_EQ(s.members.size(), 3U);
  EXPECT_TRUE(s.members[0].is_key);
  EXPECT_EQ(s.least_bytes, 13U);
  EXPECT_NE(types.find("U"), nullptr);
}

TEST(IdlParser, EnumeratorsHaveTheirOwnValues) {
  const TypeSet types = parseIdl(
      "const long TEN = 10;"
      "enum E { A, @value(5) B, C, @default_literal @value(value = -3) D, F = 40, @value(TEN) G };"
      "union U switch (E) { case B: long b; case E::D: double d; };");
  const Type& e = *types.find("E");
  for (const auto& [value, name] :
       std::map<std::int64_t, std::string>{{0, "A"}, {5, "B"}, {6, "C"}, {-3, "D"}, {40, "F"}, {10, "G"}, {1, ""}}) {
    EXPECT_EQ(enumeratorName(e, value), name);
  }
  EXPECT_EQ(chosenMember(*types.find("U"), -3)->name, "d");
  EXPECT_NE(errorOf("enum E { @value(1) A, @value(1) B };"), "");
  EXPECT_NE(errorOf("enum E { @value(5000000000) A };"), "");
}

TEST(IdlParser, ABitMaskIsAnUnsignedIntegerOfItsBits) {
  const std::string text =
      "@bit_bound(8) bitmask A { X, Y, @position(value = 4) Z }; bitmask B { X };"
      "module m { @bit_bound(9) bitmask A { @position(8) X }; @bit_bound(33) bitmask map { X, @position(32) @mine Y }; "
      "};"
      "typedef A Flags; struct S { Flags a; m::A b[1]; B c; m::map d; sequence<A> e; };";
  EXPECT_EQ(decoded(text, {0x11, 0, 0, 1, 7, 0, 0, 0x80, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0x10}),
            "a=17 b[0]=256 c=2147483655 d=4294967297 e[0]=16");
  EXPECT_EQ(errorOf("@bit_bound(2) bitmask B { X, Y,\n Z };"), "line 2: expected a bit below 2, found 2");
  EXPECT_EQ(errorOf("bitmask B { @position(3) X, @position(3) Y };"), "line 1: expected each bit once, found 3 again");
  EXPECT_EQ(errorOf("@bit_bound(65) bitmask B { X };"), "line 1: expected a whole number from 1 to 64, found 65");
  EXPECT_EQ(errorOf("@bit_bound(8) bitset B { bitfield<3> a; };"),
            "line 1: expected module, struct, union, enum, bitmask, typedef or const, found 'bitset'");
}

TEST(IdlParser, WhatChangesAPayloadIsNamed) {
  EXPECT_EQ(errorOf("@extensibility(MUTABLE) struct S { long a; };"),
            "line 1: expected a final or an appendable type, found a mutable one, whose parameter lists are not "
            "supported");
  EXPECT_EQ(errorOf("struct S { @optional long a; };"),
            "line 1: expected a member that always has its place in a payload, found @optional, which is not "
            "supported");
  EXPECT_EQ(errorOf("@bit_bound(8) enum E { A };"),
            "line 1: expected an enum of four bytes, found @bit_bound(8), which is not supported");
}

TEST(IdlParser, SaysTheLineWhatWasExpectedAndWhatWasFound) {
  EXPECT_EQ(errorOf("struct S {\n  long a\n};"), "line 3: expected ';', found '}'");
  EXPECT_EQ(errorOf("struct S { T a; };"), "line 1: expected a type that was declared before, found 'T'");
  EXPECT_EQ(errorOf("struct S { long a;"), "line 1: expected a type, found the end of the text");
  const std::string definition = "expected module, struct, union, enum, bitmask, typedef or const, found ";
  EXPECT_EQ(errorOf("\n/* never ends"), "line 2: " + definition + "a comment without its end");
  EXPECT_EQ(errorOf("\"never ends\n"), "line 1: " + definition + "a string without its end on the line");
  EXPECT_EQ(errorOf("\x81"), "line 1: " + definition + "a character that has no meaning in IDL (code 129)");
  EXPECT_EQ(errorOf("struct S { double a[1.5]; };"),
            "line 1: expected a whole number from 1 to 4294967295, found '1.5'");
}

// --- what cannot be used costs itself and what uses it

TEST(IdlParser, ADefinitionThatCannotBeUsedCostsThoseThatUseIt) {
  for (const char* definition : {"struct Odd { wstring a; };",
                                 "struct Odd { map<long, string> a; };",
                                 "struct Odd { any a; };",
                                 "struct Odd { long double a; };",
                                 "struct Odd { long a[2 / 0]; };",
                                 "struct Odd { fixed<5, 2> a; };",
                                 "struct Odd { @optional long a; };",
                                 "@mutable struct Odd { long a; };",
                                 "struct Odd : Nowhere { long b; };",
                                 "enum E { X }; struct Odd : E { long b; };",
                                 "struct Odd : Good { double a; };",
                                 "struct Odd : Odd { long b; };",
                                 "struct Odd { Elsewhere a; };",
                                 "struct Odd { long a } ;",
                                 "struct Odd {\n#if X > 3\n long a;\n#endif\n long b; };",
                                 "struct Odd { long a; \x01 };",
                                 "@bit_bound(1) bitmask Odd { X, Y };",
                                 "bitset Odd { bitfield<3> a; };",
                                 "@bit_bound(8) bitset Odd { bitfield<3> a; };",
                                 "@bit_bound(8) enum Odd { A };",
                                 "enum Odd { A = 1 << 64 };",
                                 "interface Odd { void call(in long a); };",
                                 "valuetype Odd { public long a; };",
                                 "exception Odd { long a; };",
                                 "native Odd;",
                                 "union Odd switch (float) { case 1: long a; };",
                                 "typedef long Other[1 << 1][0], Odd;",
                                 "typedef map<long, long> Odd;",
                                 "typedef struct Other { any a; } Odd;",
                                 "typedef struct Other : Good { any a; } More[2], Odd;",
                                 "@mine typedef wstring Other, Odd[3];",
                                 "typedef sequence<wstring, 4> Odd;",
                                 "struct Odd { long a; }; struct Odd { long b; };"}) {
    SCOPED_TRACE(definition);
    const TypeSet types = parseIdl(std::string("module m { struct Good { long a; };\n") + definition +
                                   "\nstruct Uses { Good a; sequence<Odd> b; }; struct UsesThat { Uses a[2]; };\n"
                                   "struct Also { Good a; }; };\nstruct Behind { m::Good a; };");
    for (const char* good : {"m::Good", "m::Also", "Behind"}) {
      EXPECT_NE(types.find(good), nullptr) << good;
      EXPECT_EQ(types.problemOf(good), nullptr) << good;
    }
    ASSERT_EQ(types.problems().size(), 1U);
    for (const char* bad : {"m::Odd", "m::Uses", "m::UsesThat"}) {
      EXPECT_EQ(types.find(bad), nullptr) << bad;
      const Problem* problem = types.problemOf(bad);
      ASSERT_NE(problem, nullptr) << bad;
      EXPECT_EQ(problem->definition, "m::Odd") << bad;
      EXPECT_EQ(problem->text.rfind("line ", 0), 0U) << problem->text;
    }
  }
}

TEST(IdlParser, AConstantThatCannotBeUsedIsNoOther) {
  const TypeSet types = parseIdl(
      "const long N = 2; struct T { long a; };\n"
      "module m {\n  const long N = 1 / 0;\n  const wstring W = L\"a\";\n  bitset T { X };\n"
      "  struct S { long a[N]; }; struct U { T a; }; struct V { ::T a[::N]; };\n};");
  EXPECT_EQ(types.find("m::S"), nullptr) << "the outer N is another one";
  EXPECT_EQ(types.find("m::U"), nullptr) << "the outer T is another one";
  EXPECT_NE(types.find("m::V"), nullptr);
  ASSERT_EQ(types.problems().size(), 3U);
  EXPECT_EQ(types.problemOf("m::S")->definition, "m::N");
  EXPECT_EQ(types.problemOf("m::S")->text.rfind("line 3: ", 0), 0U) << types.problemOf("m::S")->text;
  EXPECT_EQ(types.problemOf("m::W")->text,
            "line 4: expected a type that all encode alike, found 'wstring', which is not supported");
  EXPECT_EQ(types.problemOf("m::U")->definition, "m::T");
}

TEST(IdlParser, WhatIsWithinSomethingUnusableHasItsProblem) {
  const TypeSet types = parseIdl(
      "interface I { struct Inner { long a; }; };\n"
      "module m { struct S { long a; }; struct T { long b;\n");  // cut off
  EXPECT_EQ(types.problemOf("I::Inner")->definition, "I");
  EXPECT_NE(types.find("m::S"), nullptr);
  EXPECT_EQ(types.problemOf("m::T")->text, "line 3: expected a type, found the end of the text");
  EXPECT_EQ(types.problemOf("Nowhere"), nullptr);
}

TEST(IdlParser, SkipsForwardDeclarationsAndLinesForAPreprocessor) {
  const TypeSet types = parseIdl(
      "#ifndef A_IDL\n#define A_IDL \\\n  1\n#include \"b.idl\"\n# 7 \"a.idl\"\n"
      "module m {\n#ifdef X\nstruct S; union U;\n#endif\n"
      "struct S {\n#pragma keylist S a\n  long a;\n#line 3\n  long b; };\n#pragma keylist S a\n};\n"
      "union U switch (long) { case 1: long a; };\n#endif");
  EXPECT_TRUE(types.problems().empty()) << types.problems().front().text;
  ASSERT_NE(types.find("m::S"), nullptr);
  EXPECT_EQ(types.find("m::S")->members.size(), 2U);
  EXPECT_NE(types.find("U"), nullptr);
  EXPECT_EQ(errorOf("struct S {\n#if X\n long a;\n#endif\n};"), "line 2: expected a type, found '#if X'");
}

TEST(IdlParser, RefusesWhatWouldChangeAPayload) {
  for (const char* text :
       {"@mutable struct S { long a; };", "@extensibility(MUTABLE) struct S { long a; };",
        "@Extensibility(MUTABLE_EXTENSIBILITY) struct S { long a; };", "struct S { @optional long a; };",
        "struct S { @key @Optional long a; };", "struct S { @non_serialized long a; };", "@bit_bound(8) enum E { A };",
        "@bit_bound(16) enum E { A };", "struct S { wstring a; };", "struct S { long double a; };",
        "struct S { map<long, long> a; };", "bitset B { X };", "struct S { any a; };"}) {
    EXPECT_NE(errorOf(text), "") << text;
  }
}

TEST(IdlParser, RefusesWhatHasNoMeaning) {
  for (const char* text : {"struct S { S a; };",
                           "struct S { long a; string a; };",
                           "struct S { long a; }; struct S { long b; };",
                           "struct S { long a[0]; };",
                           "struct S { long a[-1]; };",
                           "struct S { long a[2.5]; };",
                           "struct S { string<5000000000> a; };",
                           "const string N = \"3\"; struct S { long a[N]; };",
                           "const octet N = 300;",
                           "const long N = 3.5;",
                           "const short N = 40000;",
                           "const long N = M;",
                           "const boolean B = 1;",
                           "enum E { A, A };",
                           "enum E { E };",
                           "enum E { A }; enum F { A };",
                           "enum E { };",
                           "union U switch (double) { case 1: long a; };",
                           "union U switch (long) { case 1: long a; case 1: long b; };",
                           "union U switch (long) { default: long a; default: long b; };",
                           "union U switch (long) { };",
                           "enum E { A }; enum F { B }; union U switch (E) { case B: long a; };",
                           "union U switch (boolean) { case 1: long a; };",
                           "struct S { long struct; };",
                           "struct S { \"long\" a; };",
                           "@\"key\" struct S { long a; };",
                           "@unit struct S { long a; };",
                           "@unit(3) struct S { long a; };",
                           "@default(1 struct S { long a; };",
                           "struct S { long a; } struct T { long b; };",
                           "long a;",
                           "};",
                           "\x01",
                           "\"a\\n\"",
                           "struct S { sequence<> a; };",
                           "struct S { sequence<long, 0> a; };",
                           "struct S { unsigned double a; };"}) {
    EXPECT_NE(errorOf(text), "") << text;
  }
}

TEST(IdlParser, EveryCountHasItsLimit) {
  const auto repeat = [](const std::string& text, std::size_t count) {
    std::string all;
    for (std::size_t i = 0; i < count; ++i) all += text;
    return all;
  };
  const auto numbered = [](const std::string& before, const std::string& behind, std::size_t count) {
    std::string all;
    for (std::size_t i = 0; i < count; ++i) all += before + std::to_string(i) + behind;
    return all;
  };
  EXPECT_NE(errorOf(std::string(kMaxTextBytes + 1, ' ')), "");
  EXPECT_EQ(errorOf(std::string(kMaxTextBytes, ' ')), "");
  EXPECT_EQ(errorOf(inModules(kMaxDepth, "struct S { long a; };")), "");
  EXPECT_NE(errorOf(inModules(kMaxDepth + 1, "struct S { long a; };")), "");
  EXPECT_NE(errorOf("module " + std::string(kMaxNameBytes, 'm') + " { struct S { long a; }; };"), "");
  EXPECT_NE(errorOf("struct S { " + repeat("a::", kMaxNameBytes) + "b c; };"), "");
  EXPECT_EQ(errorOf("struct S { " + numbered("long a", ";", kMaxMembers) + "};"), "");
  EXPECT_NE(errorOf("struct S { " + numbered("long a", ";", kMaxMembers + 1) + "};"), "");
  EXPECT_NE(errorOf("enum E { " + numbered("A", ",", kMaxEnumerators) + "B };"), "");
  EXPECT_NE(errorOf(numbered("const long A", " = 1;", kMaxDefinitions + 1)), "");
  EXPECT_NE(errorOf(numbered("typedef long A", ";", kMaxDefinitions + 1)), "");
  EXPECT_NE(errorOf("union U switch (long) { " + numbered("case ", ":", kMaxMembers + 1) + " long a; };"), "");
  EXPECT_NE(errorOf(repeat("any;", 500'000 / 4)), "");
  EXPECT_THROW((void)parseIdl(repeat("any;", kMaxProblems + 1)), IdlError);
  EXPECT_THROW((void)parseIdl(inModules(kMaxDepth, repeat("};", kMaxProblems + 100))), IdlError);
  EXPECT_THROW((void)parseIdl("bitset B { X };" + numbered("typedef B A", ";", kMaxDefinitions + 1)), IdlError);
  // A little text that has many members.
  const std::string base = "struct A { " + numbered("long a", ";", kMaxMembers) + "};";
  EXPECT_NE(errorOf(base + numbered("struct B", " : A { long b; };", 1)), "");
  const std::string wide = "struct A { " + numbered("long a", ";", kMaxMembers - 1) + "};";
  EXPECT_EQ(errorOf(wide + numbered("struct B", " : A { long b; };", 100)), "");
  EXPECT_NE(errorOf(wide + numbered("struct B", " : A { long b; };", 1'000)), "");
  EXPECT_NE(errorOf("struct A { long " + std::string(kMaxTextBytes / 2, 'a') + "; };" +
                    numbered("struct B", " : A { long b; };", 100)),
            "");
  // Types within each other, in every way there is.
  EXPECT_NE(errorOf("struct S { long a" + repeat("[1]", kMaxDepth + 1) + "; };"), "");
  EXPECT_NE(
      errorOf("struct S { " + repeat("sequence<", kMaxDepth + 1) + "long" + repeat(">", kMaxDepth + 1) + " a; };"), "");
  EXPECT_NE(errorOf("struct S { " + repeat("sequence<", 100'000)), "");
  std::string chain = "struct S0 { long a; };";
  for (unsigned i = 1; i <= kMaxDepth; ++i) {
    chain += "struct S" + std::to_string(i) + " { S" + std::to_string(i - 1) + " a; };";
  }
  EXPECT_NE(errorOf(chain), "");
  // What grows by a factor with each line.
  EXPECT_NE(errorOf("struct S { double a[65536][65536]; };"), "");
  std::string doubling = "struct S0 { double a; };";
  for (unsigned i = 1; i < kMaxDepth; ++i) {
    const std::string before = "S" + std::to_string(i - 1);
    doubling += "struct S" + std::to_string(i) + " { " + before + " a; " + before + " b; };";
  }
  EXPECT_NE(errorOf(doubling), "");
}

}  // namespace
}  // namespace baton::schema
