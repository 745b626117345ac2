/// The rounds of a bench.
#pragma once

#include <string>
#include <vector>

#include "report.hpp"

namespace baton::bench {

/// The cases with these names, and for a word that is no name all that contain it; all cases when there are no words.
/// Throws UsageError for a word that fits nothing.
[[nodiscard]] std::vector<Case> casesCalled(const std::vector<std::string>& words);

/// Runs the plan's cases in turn, round after round, with progress on standard error. What this build cannot do is left
/// out. Throws when a case fails or the user interrupts.
[[nodiscard]] Results measureAll(const Plan& plan, Programs& programs);

}  // namespace baton::bench
