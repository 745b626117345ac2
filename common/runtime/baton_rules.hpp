/// Who may hold the baton by the scenario, and which commands lose it. The plant goes by it, and so does a
/// MonolithicRun: one code, so that both have the same bytes.
#pragma once

#include "messages/loop.hpp"
#include "runtime/scenario.hpp"
#include "time/baton_arbiter.hpp"

namespace baton {

/// Members are numbered as the scenario lists its controllers.
[[nodiscard]] ArbiterConfig arbiterConfig(const Scenario& scenario);

/// What speaks against the command of a holder, which then loses the baton at the next step; empty when nothing does.
/// @param ails         why its law has no effort to give, where that is known; may be empty.
/// @param[out] effort  n entries [N m or N]; unspecified when something speaks against it.
[[nodiscard]] ReasonText objectionTo(const msg::JointCommand& command, const Scenario& scenario, const char* ails,
                                     JointVector& effort);

}  // namespace baton
