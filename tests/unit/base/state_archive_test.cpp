// Checkpoints of parts: what is saved comes back to the bit, and what does not fit is refused.
#include "base/state_archive.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace baton {
namespace {

struct Part {
  double number = 0.0;
  std::uint64_t count = 0;
  bool flag = false;
  Vector3 three = Vector3::Zero();
  JointVector joints;
  void archive(StateArchive& state) { state(number, count, flag, three, joints); }
};

Part somePart() {
  return {.number = -0.0,
          .count = ~std::uint64_t{0},
          .flag = true,
          .three = {1e-310, -1.0 / 3.0, INFINITY},
          .joints = JointVector::LinSpaced(5, -1.0, 1.0)};
}

std::vector<std::byte> saved(Part part) {
  std::vector<std::byte> bytes(1024);
  StateArchive archive = StateArchive::into(bytes);
  part.archive(archive);
  EXPECT_TRUE(archive.isGood());
  bytes.resize(archive.size());
  return bytes;
}

TEST(StateArchive, GivesBackWhatWasSaved) {
  const Part part = somePart();
  Part back{.joints = JointVector::Zero(8)};
  const std::vector<std::byte> bytes = saved(part);
  StateArchive archive = StateArchive::from(bytes);
  EXPECT_TRUE(archive.isRestoring());
  back.archive(archive);
  ASSERT_TRUE(archive.isWhole());
  EXPECT_TRUE(std::signbit(back.number));
  EXPECT_EQ(back.count, part.count);
  EXPECT_EQ(back.flag, part.flag);
  EXPECT_EQ(back.three, part.three);
  EXPECT_EQ(back.joints, part.joints);
  EXPECT_EQ(saved(back), bytes);
}

TEST(StateArchive, RefusesEveryOtherLength) {
  const std::vector<std::byte> bytes = saved(somePart());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Part back;
    StateArchive archive = StateArchive::from(std::span(bytes).first(length));
    back.archive(archive);
    EXPECT_FALSE(archive.isGood()) << length;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  Part back;
  StateArchive archive = StateArchive::from(longer);
  back.archive(archive);
  EXPECT_TRUE(archive.isGood());
  EXPECT_FALSE(archive.isWhole());
}

TEST(StateArchive, RefusesAFlagThatIsNeitherTrueNorFalse) {
  for (const std::uint8_t value : {2, 255}) {
    bool flag = true;
    const std::array bytes{std::byte{value}};
    StateArchive archive = StateArchive::from(bytes);
    archive(flag);
    EXPECT_FALSE(archive.isGood()) << int{value};
    EXPECT_TRUE(flag) << "left as it was";
  }
}

TEST(StateArchive, RefusesAVectorThatIsTooLong) {
  Part part = somePart();
  std::vector<std::byte> bytes = saved(part);
  const std::size_t at = bytes.size() - 5 * sizeof(double) - sizeof(std::uint32_t);
  const std::uint32_t nine = kMaxJoints + 1;
  std::memcpy(bytes.data() + at, &nine, sizeof nine);
  bytes.resize(bytes.size() + 4 * sizeof(double));
  StateArchive archive = StateArchive::from(bytes);
  part.archive(archive);
  EXPECT_FALSE(archive.isGood());
}

TEST(StateArchive, SaysWhenTheRoomIsTooSmall) {
  const std::size_t size = saved(somePart()).size();
  for (std::size_t room = 0; room < size; ++room) {
    std::vector<std::byte> bytes(room);
    Part part = somePart();
    StateArchive archive = StateArchive::into(bytes);
    part.archive(archive);
    EXPECT_FALSE(archive.isGood()) << room;
  }
}

}  // namespace
}  // namespace baton
