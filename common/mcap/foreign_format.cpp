#include "mcap/foreign_format.hpp"

#include <algorithm>
#include <array>

namespace baton::mcap {

const ForeignFormat* foreignFormat(std::string_view begin) {
  using namespace std::string_view_literals;
  static constexpr std::array kFormats{
      ForeignFormat{"SQLite format 3", "an SQLite database, as rosbag2 records in (.db3)",
                    "`ros2 bag convert` or `mcap convert` makes an MCAP file of it", false},
      ForeignFormat{"#ROSBAG V", "a ROS 1 bag", "`mcap convert` makes an MCAP file of it", false},
      ForeignFormat{"\x28\xb5\x2f\xfd"sv, "compressed with zstd", "decompress it with `zstd -d` first", true},
      ForeignFormat{"\x1f\x8b"sv, "compressed with gzip", "decompress it with `gunzip` first", true},
      ForeignFormat{"BZh", "compressed with bzip2", "decompress it with `bunzip2` first", true},
      ForeignFormat{"\xfd\x37zXZ"sv, "compressed with xz", "decompress it with `unxz` first", true},
      ForeignFormat{"\x04\x22\x4d\x18"sv, "compressed with LZ4", "decompress it with `lz4 -d` first", true},
      ForeignFormat{"PK\x03\x04"sv, "a zip archive", "take the file out of it with `unzip` first", true},
      ForeignFormat{"\x89HDF"sv, "an HDF5 file", "", false},
  };
  const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                   [&](const ForeignFormat& one) { return begin.starts_with(one.magic); });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace baton::mcap
