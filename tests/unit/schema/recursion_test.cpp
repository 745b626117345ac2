/// Types that are declared before they are defined, and those that contain sequences of themselves.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "schema/limits.hpp"
#include "unit/schema/decoded.hpp"

namespace baton::schema {
namespace {

using test::decoded;

const std::string kAny = "expected a type that all encode alike, found 'any', which is not supported";
const std::string kOpen =
    "expected a type that is defined before, or a sequence of one that is not (recursion), found ";

TEST(Recursion, AStructMayContainSequencesOfItself) {
  const std::vector<int> body{1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0};
  for (const char* text :
       {"struct S; typedef sequence<S> Nodes; struct S { octet v; Nodes nodes; };",
        "struct S { octet v; sequence<S> nodes; };",
        "struct Node; struct S { octet v; sequence<Node, 2> nodes; }; struct Node { octet v; sequence<Node> nodes; };",
        "struct T { any a; }; module m { struct T; struct T; typedef sequence<T> Nodes;"
        "  @final struct T { octet v; Nodes nodes; }; struct T; }; typedef m::T S;"}) {
    EXPECT_EQ(decoded(text, body), "v=1 nodes[0].v=2 nodes[1].v=3") << text;
  }
  EXPECT_EQ(decoded("union U; struct L { sequence<U> u; };"
                    "union U switch (octet) { case 1: L l; case 2: octet o; }; struct S { U u; };",
                    {1, 0, 0, 0, 1, 0, 0, 0, 2, 9}),
            "u.$discriminator=1 u.l.u[0].$discriminator=2 u.l.u[0].o=9");
}

TEST(Recursion, APayloadNestsAsDeepAsTypesDo) {
  const std::string text = "struct S { sequence<S> s; };";
  const auto nested = [](unsigned count) {  // each within the one before
    std::vector<int> body;
    for (unsigned i = 0; i < count; ++i) body.insert(body.end(), {i + 1 < count ? 1 : 0, 0, 0, 0});
    return body;
  };
  EXPECT_EQ(decoded(text, nested(kMaxDepth / 2)), "");  // a struct and a sequence each time
  const std::string error = decoded(text, nested(kMaxDepth / 2 + 1));
  EXPECT_TRUE(error.ends_with(".s[0]: expected at most 32 values within each other, found more")) << error;
}

TEST(Recursion, OnlySequencesMayBeOfWhatIsNotDefinedYet) {
  EXPECT_EQ(decoded("struct S {\n S a; };", {}), "S: line 2: " + kOpen + "'S'");
  EXPECT_EQ(decoded("struct Q; struct S { Q a[2]; }; struct Q { octet a; };", {}), "S: line 1: " + kOpen + "'Q'");
  EXPECT_EQ(decoded("struct Q; typedef Q S;", {}), "S: line 1: " + kOpen + "'Q'");
  EXPECT_EQ(decoded("struct Q; struct S : Q { octet a; };", {}), "S: line 1: " + kOpen + "'Q'");
  EXPECT_EQ(decoded("struct S : S { octet a; };", {}), "S: line 1: " + kOpen + "'S'");
  EXPECT_EQ(decoded("union S switch (octet) { case 1: S a; };", {}), "S: line 1: " + kOpen + "'S'");
}

TEST(Recursion, WhatIsNowhereDefinedCostsThoseThatUseIt) {
  const std::string text =
      "struct T { octet a; }; module m {\nstruct Q; struct T; struct Unused; union Never;"
      "struct S { sequence<Q> q; }; typedef S U; struct V { U u[2]; }; struct Good { ::T t; }; }; typedef m::V S;";
  EXPECT_EQ(decoded(text, {}), "m::Q: line 2: expected its definition, found a declaration alone");
  const TypeSet types = parseIdl(text);
  EXPECT_EQ(types.problems().size(), 1U);
  for (const char* name : {"m::Q", "m::S", "m::U", "m::V", "S", "m::Unused", "m::Never", "m::T"}) {
    EXPECT_EQ(types.find(name), nullptr) << name;
  }
  EXPECT_NE(types.find("m::Good"), nullptr);
  EXPECT_EQ(types.problemOf("m::Unused"), nullptr);
}

TEST(Recursion, WhatCannotBeDefinedCostsThoseThatUseIt) {
  const std::string uses = "struct Q; struct S { sequence<Q> q; };\n";
  EXPECT_EQ(decoded(uses + "struct Q { any a; };", {}), "Q: line 2: " + kAny);
  EXPECT_EQ(decoded(uses + "struct Q { sequence<Q> q; any a; };", {}), "Q: line 2: " + kAny);
  EXPECT_EQ(decoded(uses + "struct Q { any a; }; struct Q { octet a; };", {}), "Q: line 2: " + kAny);
  EXPECT_EQ(decoded(uses + "union Q switch (octet) { case 1: octet a; };", {}),
            "Q: line 2: expected a new name, found 'Q' again");
}

TEST(Recursion, DeclarationsHaveTheLimitOfTypes) {
  std::string declarations, chain;
  for (std::size_t i = 0; i <= kMaxDefinitions; ++i) declarations += "struct A" + std::to_string(i) + ";";
  EXPECT_THROW((void)parseIdl(declarations), IdlError);
  for (std::size_t i = 0; i < 5'000; ++i) {
    const std::string next = std::to_string(i + 1);
    chain += "struct A" + next + "; struct A" + std::to_string(i) + " { sequence<A" + next + "> a; };\n";
  }
  const TypeSet types = parseIdl(chain);
  EXPECT_EQ(types.find("A0"), nullptr) << "the last one has no definition";
  EXPECT_EQ(types.problemOf("A0")->definition, "A5000");
}

}  // namespace
}  // namespace baton::schema
