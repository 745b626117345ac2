/// Who has to listen before the first message goes out: a number of processes on every topic, processes by name, or
/// both.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dds/types.hpp"

namespace baton {

/// The processes that read what each writer sends, with the names of their services; by topic, which may have several
/// writers.
using Readers = std::multimap<std::string, std::map<dds::GuidPrefix, std::string>>;

class Audience {
 public:
  /// Whoever is called by name need not read every topic, so nobody knows how many of its readers are still to be
  /// found; it is taken to be here when none has been for this long.
  static constexpr std::int64_t kSettled_ns = 500'000'000;

  /// @param count  processes on every topic.
  /// @param names  services that read at least one.
  Audience(std::size_t count, std::vector<std::string> names) : count_(count), names_(std::move(names)) {}

  /// Who is missing, in words; empty when everybody is here. To be asked again and again, with the present readers.
  [[nodiscard]] std::string missing(const Readers& readers, std::int64_t now_ns);

 private:
  std::size_t count_;
  std::vector<std::string> names_;
  std::optional<Readers> seen_;
  std::int64_t changed_ns_ = 0;
};

}  // namespace baton
