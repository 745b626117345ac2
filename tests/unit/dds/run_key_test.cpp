#include "dds/run_key.hpp"

#include <gtest/gtest.h>

#include <set>

namespace baton::dds {
namespace {

constexpr GuidPrefix kHost{1, 15, 7, 8, 0, 0, 0, 0, 0, 0, 0, 1};

TEST(RunKey, MarksPrefixesThatItRecognises) {
  const RunKey key = RunKey::fresh();
  std::set<GuidPrefix> marked;
  for (int i = 0; i < 100; ++i) {
    const GuidPrefix prefix = key.marked(kHost);
    EXPECT_TRUE(key.isMarked(prefix));
    EXPECT_TRUE(std::equal(kHost.begin(), kHost.begin() + 4, prefix.begin())) << "vendor and host";
    marked.insert(prefix);
  }
  EXPECT_EQ(marked.size(), 100U) << "participants of one process differ";
}

TEST(RunKey, RecognisesNoOther) {
  const RunKey key = RunKey::fresh();
  EXPECT_FALSE(key.isMarked(kHost));
  EXPECT_FALSE(key.isMarked(RunKey::fresh().marked(kHost)));
  GuidPrefix changed = key.marked(kHost);
  for (std::uint8_t& byte : changed) {
    byte ^= 1;
    EXPECT_FALSE(key.isMarked(changed));
    byte ^= 1;
  }
  EXPECT_TRUE(key.isMarked(changed));
}

/// By hand: HMAC-SHA256 of the eight bytes 01 0f 07 08 00 00 00 00, as `openssl dgst -mac hmac` computes it.
TEST(RunKey, IsWhatOtherProgramsComputeToo) {
  const auto key = RunKey::parse("000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f");
  ASSERT_TRUE(key.has_value());
  EXPECT_TRUE(key->isMarked({1, 15, 7, 8, 0, 0, 0, 0, 181, 229, 114, 17}));
}

TEST(RunKey, IsReadAsItIsWritten) {
  const RunKey key = RunKey::fresh();
  EXPECT_EQ(RunKey::parse(key.text()), key);
  EXPECT_NE(RunKey::fresh(), key);
  const std::string text = key.text();
  for (const std::string& wrong : {std::string(), text.substr(1), text + "0", "g" + text.substr(1),
                                   "-" + text.substr(1), " " + text.substr(1), "+" + text.substr(1)}) {
    EXPECT_FALSE(RunKey::parse(wrong).has_value()) << wrong;
  }
}

}  // namespace
}  // namespace baton::dds
