/// Words of IDL texts that are names, though they look like something else.
#include "schema/idl_names.hpp"

#include <gtest/gtest.h>

#include <string>

#include "unit/schema/decoded.hpp"

namespace baton::schema {
namespace {

using test::decoded;

TEST(IdlNames, AnUnderscoreThatEscapesIsNoPartOfTheName) {
  EXPECT_EQ(decoded("module _module { struct _union { octet _struct; octet _a; }; enum _enum { _case }; };"
                    "typedef _module::_union _T; struct _S { T t; ::_module::_enum _long[1]; };"
                    "struct Last { octet a; };",
                    {1, 2, 0, 0, 3, 0, 0, 0}),
            "t.struct=1 t.a=2 long[0]=3");
  EXPECT_EQ(decoded("const long _N = 2; struct S { octet a[N]; };", {1, 2}), "a=2 octets");
  EXPECT_EQ(decoded("struct S { octet __a; octet _1; };", {1, 2}), "__a=1 _1=2") << "these escape nothing";
  EXPECT_EQ(decoded("struct S { octet a; octet _a; };", {1, 2}),
            "S: line 1: expected each member's name once, found 'a' again");
  EXPECT_EQ(decoded("struct _S { map<long, long> a; };", {}),
            "S: line 1: expected a type that all encode alike, found 'map', which is not supported");
  EXPECT_EQ(decoded("typedef double _long; struct S { long a; };", {1, 0, 0, 0}), "a=1") << "not escaped: the keyword";
}

TEST(IdlNames, WordsThatIdlKnowsElsewhereAreNamesWhereANameStands) {
  EXPECT_EQ(decoded("struct OccupancyGrid { octet data; }; struct S { OccupancyGrid map; octet any, set; octet bitmask;"
                    "  octet bitset; octet fixed; octet interface; octet int8; octet module_; };",
                    {1, 2, 3, 4, 5, 6, 7, 8, 9}),
            "map.data=1 any=2 set=3 bitmask=4 bitset=5 fixed=6 interface=7 int8=8 module_=9");
  EXPECT_EQ(decoded("module map { struct any { octet a; }; enum set { bitset, fixed }; }; typedef map::any bitmask;"
                    "struct S { bitmask map; map::any any[1]; map::set set; };",
                    {1, 2, 0, 0, 1, 0, 0, 0}),
            "map.a=1 any[0].a=2 set=1");
}

TEST(IdlNames, ATextsOwnInt8IsItsOwn) {
  EXPECT_EQ(decoded("typedef short int8; struct map { int8 a; }; struct S { int8 a; uint8 b; map c; };",
                    {0xFE, 0xFF, 3, 0, 4, 0}),
            "a=-2 b=3 c.a=4");
  EXPECT_EQ(decoded("module m { typedef short int8; }; struct S { int8 a; m::int8 b; };", {0xFE, 0, 4, 0}), "a=-2 b=4");
}

TEST(IdlNames, KeywordsOfEveryVersionAreNoNames) {
  for (const char* word : {"struct", "long", "string", "sequence", "TRUE", "wchar", "default"}) {
    const std::string text = "struct S { octet " + std::string(word) + "; };";
    EXPECT_EQ(decoded(text, {1}), "S: line 1: expected a name, found '" + std::string(word) + "'");
  }
  for (const char* word : {"wstring", "fixed<5, 2>", "any", "map<long, long>"}) {
    const std::string text = "struct S { " + std::string(word) + " a; };";
    EXPECT_NE(decoded(text, {1}).find("a type that all encode alike, found '"), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace baton::schema
