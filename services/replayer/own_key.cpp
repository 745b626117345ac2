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

bool isIn(const std::filesystem::path& folder, const dds::RunKey& key) {
  const std::string file = keyFile(placeIn(folder));
  return std::filesystem::exists(file) && readKey(file) == key;
}

}  // namespace

OwnKey::OwnKey(int domain, const std::string& cell, const std::string& run)
    : folder_(replayFolder(domain, cell, run)), key_(made(folder_)) {
  constexpr int kAttempts = 10;
  for (int attempt = 0; !holdsFolder(); ++attempt) {
    if (attempt == kAttempts) {
      throw UnavailableError("cannot lock " + folder_.string() + ": expected a file system with locks (flock)");
    }
    key_ = made(folder_);
  }
}

/// Another replay of that name may have ended meanwhile, and taken the folder with it.
bool OwnKey::holdsFolder() {
  in_use_.emplace(open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return flock(in_use_->get(), LOCK_SH) == 0 && isIn(folder_, key_);
}

OwnKey::~OwnKey() {
  std::error_code ignored;
  if (flock(in_use_->get(), LOCK_EX | LOCK_NB) == 0) std::filesystem::remove_all(folder_, ignored);
}

}  // namespace baton
