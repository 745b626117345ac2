/// What is replayed, message after message.
#include "playlist.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.hpp"
#include "mcap/writer.hpp"
#include "support/processes.hpp"

namespace baton {
namespace {

class PlaylistTest : public testing::Test {
 protected:
  PlaylistTest() {
    const std::filesystem::path file = bench.folder() / "a.mcap";
    options.recording.given = {file.string()};
    mcap::Writer writer(file);
    const auto map = writer.addChannel("map", "cdr", mcap::kNoSchema, {{"type", "T"}, {"qos", "durability: true\n"}});
    const auto rate =
        writer.addChannel("rate", "cdr", mcap::kNoSchema, {{"type", "T"}, {"qos", "durability: false\n"}});
    std::uint32_t sequence = 0;
    for (const std::uint64_t time : {0, 10, 20, 30}) {
      writer.write(map, ++sequence, time, time + 1, {});
      writer.write(rate, ++sequence, time + 5, time + 6, {});
    }
    writer.close();
  }
  /// Sequence numbers with the log times at which they are due.
  static std::vector<std::pair<std::uint32_t, std::uint64_t>> rest(Playlist& playlist) {
    std::vector<std::pair<std::uint32_t, std::uint64_t>> found;
    for (mcap::MessageView message; playlist.next(message);) {
      EXPECT_EQ(message.publish_time_ns % 5, 1u) << "as it was published";
      found.emplace_back(message.sequence, message.log_time_ns);
    }
    return found;
  }
  using Due = std::vector<std::pair<std::uint32_t, std::uint64_t>>;
  test::Bench bench;
  ReplayOptions options;
};

TEST_F(PlaylistTest, InTheMiddleItBeginsWithWhatALateJoinerWouldBeGivenInEachPass) {
  options.range.from_s = 25.5e-9;
  Playlist playlist(options);
  const Due all{{5, 25}, {6, 25}, {7, 30}, {8, 35}};
  EXPECT_EQ(rest(playlist), all);
  EXPECT_EQ(playlist.total(), 4u);
  playlist.rewind();
  EXPECT_EQ(rest(playlist), all);
  playlist.seek(30);
  EXPECT_EQ(rest(playlist), (Due{{7, 30}, {8, 35}})) << "readers that are there have had it";
}

TEST_F(PlaylistTest, WithoutItWhenToldAndAtTheBeginningThereIsNothingBefore) {
  Playlist whole(options);
  EXPECT_EQ(rest(whole).size(), 8u);
  options.range.from_s = 25.5e-9;
  options.without_latched = true;
  Playlist bare(options);
  EXPECT_EQ(rest(bare), (Due{{6, 25}, {7, 30}, {8, 35}}));
  options.without_latched = false;
  options.topics = {"rate"};
  Playlist other(options);
  EXPECT_EQ(rest(other), (Due{{6, 25}, {8, 35}})) << "of the chosen topics";
}

TEST_F(PlaylistTest, ARangeWithNothingInItIsRefused) {
  options.range.from_s = 26e-9;
  options.range.to_s = 28e-9;
  EXPECT_THROW(Playlist{options}, UsageError) << "though there is something from before";
}

}  // namespace
}  // namespace baton
