#include "own_key.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include "runtime/cell.hpp"

namespace baton {
namespace {

RunInfo placeIn(const std::filesystem::path& folder) {
  RunInfo place;
  place.folder = folder.string();
  return place;
}

dds::RunKey made(const std::filesystem::path& folder) {
  makePrivateFolder(folder);
  makeKeyWhenMissing(placeIn(folder));
  return readKey(keyFile(placeIn(folder)));
}

}  // namespace

OwnKey::OwnKey(int domain, const std::string& cell, const std::string& run)
    : folder_(replayFolder(domain, cell, run)),
      key_(made(folder_)),
      in_use_(open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  flock(in_use_.get(), LOCK_SH);
}

OwnKey::~OwnKey() {
  std::error_code ignored;
  if (flock(in_use_.get(), LOCK_EX | LOCK_NB) == 0) std::filesystem::remove_all(folder_, ignored);
}

}  // namespace baton
