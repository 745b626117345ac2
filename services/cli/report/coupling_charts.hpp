/// The charts of the co-simulation study: what it costs that the plant hears of the wall once a step, by coupling rule.
#pragma once

#include "study.hpp"

namespace baton::study {

/// What a chart is made of.
struct Inputs {
  const std::vector<Trace>& runs;  // all of the figure
  const Trace& base;               // the one that is varied
  const ShowProgress& progress;
};

/// Energy of a sprung mass over time, of all recorded runs of the figure, beside the exponentials of theory.
[[nodiscard]] ChartResult couplingEnergy(const Inputs& in);

/// Over stiffness and step, where the motion of a damped sprung mass dies out, and where theory says that it does. From
/// a hundredth of the run's stiffness to ten times, and from a sixtieth of its step to six times; beyond half a swing a
/// step nothing is computed.
[[nodiscard]] ChartResult couplingStability(const Inputs& in);

/// Where the tip is at the end of the run, against a run with derivatives and a far finer step, over the step. The law
/// must not depend on the step, so that nothing but the coupling does.
[[nodiscard]] ChartResult couplingError(const Inputs& in);

}  // namespace baton::study
