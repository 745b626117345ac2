/// Instances: the values of key members.
#include "schema/instance.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "schema/idl_parser.hpp"

namespace baton::schema {
namespace {

/// The body of a payload, octet by octet, after its header.
std::string instanceFor(const std::string& idl, std::vector<int> body) {
  const TypeSet types = parseIdl(idl);
  std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  for (const int one : body) bytes.push_back(static_cast<std::byte>(one));
  return instanceOf(*types.find("S"), bytes);
}

TEST(Instance, IsTheSameForTheSameKeysAlone) {
  const std::string idl = "struct S { octet a; @key octet id; octet b; @key octet part; };";
  EXPECT_EQ(instanceFor(idl, {1, 2, 3, 4}), instanceFor(idl, {9, 2, 8, 4}));
  EXPECT_NE(instanceFor(idl, {1, 2, 3, 4}), instanceFor(idl, {1, 2, 3, 5}));
  EXPECT_NE(instanceFor(idl, {1, 2, 3, 4}), instanceFor(idl, {1, 4, 3, 2}));
}

TEST(Instance, AStructThatIsAKeyCountsWithAllThatIsInIt) {
  const std::string idl = "struct P { octet x; octet y; }; struct S { @key P at; P to; };";
  EXPECT_EQ(instanceFor(idl, {1, 2, 3, 4}), instanceFor(idl, {1, 2, 8, 9}));
  EXPECT_NE(instanceFor(idl, {1, 2, 3, 4}), instanceFor(idl, {1, 3, 3, 4}));
}

TEST(Instance, TextsThatShiftDoNotMeet) {
  const std::string idl = "struct S { @key sequence<octet> a; @key sequence<octet> b; };";
  const std::vector<int> one{1, 0, 0, 0, 7, 0, 0, 0, 2, 0, 0, 0, 7, 7}, other{2, 0, 0, 0, 7, 7, 0, 0, 1, 0, 0, 0, 7};
  EXPECT_FALSE(instanceFor(idl, one).empty());
  EXPECT_NE(instanceFor(idl, one), instanceFor(idl, other));
}

TEST(Instance, OfATypeWithoutKeysOrOfOtherBytesThereIsOne) {
  EXPECT_EQ(instanceFor("struct S { octet a; };", {1}), "");
  EXPECT_EQ(instanceFor("struct S { @key unsigned long long id; };", {1, 2}), "");
}

}  // namespace
}  // namespace baton::schema
