/// The key of a replay, a file that only its user can read: who can read it may pause the replay, seek and stop it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "dds/run_key.hpp"
#include "mcap/file.hpp"

namespace baton {

/// There for as long as a replay of that name lives.
class OwnKey {
 public:
  /// Throws UnavailableError when it cannot be written, read or locked.
  OwnKey(int domain, const std::string& cell, const std::string& run);
  ~OwnKey();
  OwnKey(const OwnKey&) = delete;
  OwnKey& operator=(const OwnKey&) = delete;

  [[nodiscard]] const dds::RunKey& key() const { return key_; }

 private:
  [[nodiscard]] bool holdsFolder();

  std::filesystem::path folder_;
  dds::RunKey key_;
  std::optional<mcap::Descriptor> in_use_;  // its lock is shared by all replays of that name
};

}  // namespace baton
