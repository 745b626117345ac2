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
    const Role role = static_cast<Role>(i % kRoles);
    const GuidPrefix prefix = key.marked(kHost, role);
    EXPECT_EQ(key.roleOf(prefix), role);
    EXPECT_TRUE(std::equal(kHost.begin(), kHost.begin() + 4, prefix.begin())) << "vendor and host";
    marked.insert(prefix);
  }
  EXPECT_EQ(marked.size(), 100U) << "participants of one process differ";
}

TEST(RunKey, RecognisesNoOther) {
  const RunKey key = RunKey::fresh();
  EXPECT_FALSE(key.roleOf(kHost));
  EXPECT_FALSE(key.roleOf(RunKey::fresh().marked(kHost, Role::kPlant)));
  GuidPrefix changed = key.marked(kHost, Role::kPlant);
  for (std::uint8_t& byte : changed) {
    byte ^= 1;
    EXPECT_FALSE(key.roleOf(changed));
    byte ^= 1;
  }
  EXPECT_EQ(key.roleOf(changed), Role::kPlant);
}

/// HMAC-SHA256 of the eight bytes 01 0f 07 08 00 00 00 00, and of those of a prefix and a text, as computed by
/// `openssl dgst -mac hmac`.
TEST(RunKey, IsWhatOtherProgramsComputeToo) {
  const auto key = RunKey::parse("000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f");
  ASSERT_TRUE(key.has_value());
  const GuidPrefix plant{1, 15, 7, 8, 0, 0, 0, 0, 0xb5, 0xe5, 0x72, 0x11};
  EXPECT_EQ(key->roleOf(plant), Role::kPlant);
  EXPECT_EQ(key->roleOf({1, 15, 7, 8, 0, 0, 0, 0, 0x25, 0xf1, 0xca, 0x68}), Role::kEnvironment);
  EXPECT_EQ(key->roleOf({1, 15, 7, 8, 0, 0, 0, 0, 0xd4, 0xd9, 0x0e, 0xa6}), Role::kOperator);
  EXPECT_EQ(key->proofOf(plant, "who"), "c9a956894f7cfe36607ac8ed647f0595");
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
