/// What a terminal's bytes mean.
#include "terminal.hpp"

#include <gtest/gtest.h>

namespace baton {
namespace {

using Keys = std::vector<Key>;

TEST(Keys, AreTakenInTheirOrder) {
  std::string bytes = " +=-qQ";
  EXPECT_EQ(takeKeys(bytes), (Keys{Key::kSpace, Key::kPlus, Key::kPlus, Key::kMinus, Key::kQuit, Key::kQuit}));
  EXPECT_TRUE(bytes.empty());
}

TEST(Keys, ArrowsComeInBothWaysATerminalSendsThem) {
  std::string bytes = "\033[C\033[D\033OC\033OD\033[1;5C";
  EXPECT_EQ(takeKeys(bytes), (Keys{Key::kRight, Key::kLeft, Key::kRight, Key::kLeft, Key::kRight}));
}

TEST(Keys, ASequenceInPiecesIsPutTogether) {
  std::string bytes = " \033";
  EXPECT_EQ(takeKeys(bytes), Keys{Key::kSpace});
  bytes += "[";
  EXPECT_EQ(takeKeys(bytes), Keys{});
  bytes += "C";
  EXPECT_EQ(takeKeys(bytes), Keys{Key::kRight});
}

TEST(Keys, OthersArePassedOver) {
  std::string bytes = "xyz\033[A\033[3~\t\033q\n ";
  EXPECT_EQ(takeKeys(bytes), (Keys{Key::kQuit, Key::kSpace})) << "a lone escape is no part of the q behind it";
}

}  // namespace
}  // namespace baton
