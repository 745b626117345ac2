#include "runtime/build_id.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <fstream>
#include <span>

#include "base/error.hpp"
#include "dds/hash.hpp"
#include "runtime/paths.hpp"

namespace baton {

std::string buildId() {
  std::uint64_t hash = 0;
  std::array<char, 1 << 16> piece{};
  for (const char* name : {"baton-plant", "baton-environment", "baton-trajectory", "baton-controller"}) {
    std::ifstream program(siblingProgram(name), std::ios::binary);
    while (program.read(piece.data(), piece.size()), program.gcount() > 0) {
      hash = dds::chainHash(hash, std::as_bytes(std::span(piece).first(static_cast<std::size_t>(program.gcount()))));
    }
    if (program.bad()) throw UnavailableError(std::string("cannot read the program ") + name);
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace baton
