/// Runs of the report's scenarios in this process, for tests of what is made of recordings.
#pragma once

#include <string>
#include <vector>

#include "report/trace.hpp"

namespace baton::test {

/// A change to a file's text.
struct TextChange {
  std::string from;  // there once
  std::string to;
};

/// The scenario of that name below deploy/scenarios/report, with changes to its text. Throws std::runtime_error when
/// what is to be changed is not there once.
[[nodiscard]] Scenario reportScenario(const std::string& name, const std::vector<TextChange>& changes = {});

/// The trace that a recording of the run would give, under the controller that is active at the start. Throws
/// std::runtime_error when the law or the arm fails.
[[nodiscard]] Trace simulate(const Scenario& scenario);

}  // namespace baton::test
