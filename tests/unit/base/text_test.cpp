#include "base/text.hpp"

#include <gtest/gtest.h>

#include "base/plural.hpp"

namespace baton {
namespace {

TEST(Text, IsPlainWithoutControlCharacters) {
  EXPECT_TRUE(isPlain("plain, \u00fcmlaut"));
  for (const char* text : {"\n", "a\tb", "\x1b", "a\x7f", "\xc2\x85", "\xc2\x9b", "\x9b", "\xfcmlaut"}) {
    EXPECT_FALSE(isPlain(text)) << escaped(text);
  }
}

TEST(Text, InJsonIsEscapedAsJsonDoes) {
  EXPECT_EQ(escapedInJson("\"\u00fc\xc2\xa0\x7f\xc2\x80\xc2\x9b\xc2\""), "\"\u00fc\xc2\xa0\\u007f\\u0080\\u009b\xc2\"");
}

TEST(Text, IsEscapedSoThatItChangesNoTerminalAndNoLine) {
  EXPECT_EQ(escaped("plain, \u00fcmlaut \U0001f916"), "plain, \u00fcmlaut \U0001f916");
  EXPECT_EQ(escaped("a\x1b[31m\a\nb\x7f"), "a\\x1b[31m\\x07\\nb\\x7f");
  EXPECT_EQ(escaped("a\nb\t", true), "a\nb\\x09");
  EXPECT_EQ(escaped("\xc2\x9b"
                    "2J"),
            "\\u009b2J")
      << "the same as ESC [ to some terminals";
  EXPECT_EQ(escaped("\xff\xc3(\xed\xa0\x80\xc0\x80\xe2\x82"), "\\xff\\xc3(\\xed\\xa0\\x80\\xc0\\x80\\xe2\\x82");
  EXPECT_EQ(escaped(std::string_view("\0", 1)), "\\x00");
}

TEST(Text, AFileNameLeadsToNoOtherFolder) {
  EXPECT_TRUE(isFileName("a.mcap", ".mcap"));
  EXPECT_TRUE(isFileName("demo step 3.mcap", ".mcap"));
  for (const char* name : {"", ".mcap", "a", "a.mcap2", "/a.mcap", "b/a.mcap", "../a.mcap", ".a.mcap", "..", "a\n.mcap",
                           "a\xc2\x9b.mcap", "/root/.ssh/authorized_keys", "a.mcap/"}) {
    EXPECT_FALSE(isFileName(name, ".mcap")) << name;
  }
}

TEST(Counted, HasAnSUnlessThereIsOne) {
  EXPECT_EQ(counted(0, "message"), "0 messages");
  EXPECT_EQ(counted(1, "message"), "1 message");
  EXPECT_EQ(counted(2, "more file"), "2 more files");
  EXPECT_EQ(std::string(areOrIs(1)) + " " + areOrIs(2), "is are");
}

}  // namespace
}  // namespace baton
