#include "made_with.hpp"

#include <gtest/gtest.h>

#include "runtime/platform.hpp"

namespace baton::test {
namespace {

TEST(MadeWith, NamesWhatDiffersInTheOrderOfLikelyCauses) {
  const mcap::StringMap then{{"processor", "A"}, {"mathematics", "SLEEF 3.5.1"}, {"libc", "glibc 2.36"}, {"host", "a"}};
  const mcap::StringMap now{{"processor", "B"}, {"mathematics", "SLEEF 3.6.1"}, {"libc", "glibc 2.36"}, {"host", "b"}};
  const std::vector<MadeWithDifference> differences = madeWithDifferences(then, now);
  ASSERT_EQ(differences.size(), 2U) << "which host it was is no cause";
  EXPECT_EQ(toText(differences),
            "mathematics: SLEEF 3.5.1 in the recording, SLEEF 3.6.1 now; processor: A in the recording, B now");
  EXPECT_TRUE(madeWithDifferences(then, then).empty());
}

TEST(MadeWith, WhatOnlyOneOfThemSaysComesLastAndByNameAlone) {
  const mcap::StringMap then{{"processor", "A"}};
  const mcap::StringMap now{{"processor", "B"}, {"mathematics", "SLEEF 3.6.1"}, {"libc", "glibc 2.41"}};
  EXPECT_EQ(toText(madeWithDifferences(then, now)),
            "processor: A in the recording, B now; one of the two does not say its mathematics, libc");
  EXPECT_EQ(toText(madeWithDifferences({}, {{"compiler", "GNU 12.2.0"}})), "one of the two does not say its compiler");
}

/// Every key of the platform is one that is compared.
TEST(MadeWith, ComparesAllOfThePlatform) {
  const std::map<std::string, std::string> here = platform();
  EXPECT_EQ(madeWithDifferences({}, {here.begin(), here.end()}).size(), here.size());
  for (const auto& [key, value] : here) EXPECT_FALSE(value.empty()) << key;
  EXPECT_NE(here.at("mathematics").find("SLEEF 3."), std::string::npos);
}

}  // namespace
}  // namespace baton::test
