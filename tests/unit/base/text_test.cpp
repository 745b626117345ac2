#include "base/text.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

TEST(Text, IsShownOnOneLineWithoutControlCharacters) {
  EXPECT_EQ(printable("plain, ümlaut"), "plain, ümlaut");
  EXPECT_EQ(printable("a\x1b[31m\a\nb\x7f"), "a [31m  b ");
  EXPECT_FALSE(hasControlCharacters("plain, ümlaut"));
  for (const char* text : {"\n", "a\tb", "\x1b", "a\x7f"}) EXPECT_TRUE(hasControlCharacters(text));
}

TEST(Text, AFileNameLeadsToNoOtherFolder) {
  EXPECT_TRUE(isFileName("a.mcap", ".mcap"));
  EXPECT_TRUE(isFileName("demo step 3.mcap", ".mcap"));
  for (const char* name : {"", ".mcap", "a", "a.mcap2", "/a.mcap", "b/a.mcap", "../a.mcap", ".a.mcap", "..", "a\n.mcap",
                           "/root/.ssh/authorized_keys", "a.mcap/"}) {
    EXPECT_FALSE(isFileName(name, ".mcap")) << name;
  }
}

}  // namespace
}  // namespace baton
