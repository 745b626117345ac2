/// What two recordings were made with, compared: the first thing to look at when equal runs have other bytes.
#pragma once

#include <string>
#include <vector>

#include "mcap/records.hpp"

namespace baton {

/// A value of the metadata record baton.run, in the recording and in its repetition. An older recording may lack it.
struct MadeWithDifference {
  std::string key;
  std::string then;
  std::string now;
};

/// What differs of what a run's numbers depend on: programs, compiler, libraries, processor. In the order in which it
/// is likely to be the cause.
[[nodiscard]] std::vector<MadeWithDifference> madeWithDifferences(const mcap::StringMap& then,
                                                                  const mcap::StringMap& now);

/// As in "mathematics: SLEEF 3.5.1 in the recording, SLEEF 3.6.1 now". What only one of the two says comes last, by
/// name alone: nobody can tell whether it differs.
[[nodiscard]] std::string toText(const std::vector<MadeWithDifference>& differences);

}  // namespace baton
