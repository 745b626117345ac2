#include "control/handover_meter.hpp"

#include <algorithm>

namespace baton {

HandoverMeter::HandoverMeter(double step_s, const JointVector& effort_rate_limit)
    : step_s_(step_s), limit_(effort_rate_limit) {
  measure_.max_effort_rate = JointVector::Zero(limit_.size());
}

void HandoverMeter::start(std::uint64_t K, std::uint64_t steps) noexcept {
  left_ = std::max<std::uint64_t>(steps, 1);
  measure_ = {};
  measure_.at_step = K;
  measure_.max_effort_rate = JointVector::Zero(limit_.size());
}

void HandoverMeter::add(const HandoverStep& step) noexcept {
  if (!isRunning()) return;
  --left_;
  if (measure_.steps++ == 0) f_K_ = step.f_e;
  const JointVector rate = (step.tau - step.tau_before).cwiseAbs() / step_s_;
  measure_.max_effort_rate = measure_.max_effort_rate.cwiseMax(rate);
  measure_.rate_limit_hits += static_cast<std::uint64_t>((rate.array() > limit_.array()).count());
  measure_.peak_force_deviation = std::max(measure_.peak_force_deviation, (step.f_e - f_K_).norm());
  measure_.blend_energy += step.residual.dot(step.dq);
}

void HandoverMeter::archive(StateArchive& state) noexcept {
  HandoverMeasure& m = measure_;
  state(left_, f_K_, m.at_step, m.steps, m.max_effort_rate, m.rate_limit_hits, m.peak_force_deviation, m.blend_energy);
  if (m.max_effort_rate.size() != limit_.size()) state.fail();
}

}  // namespace baton
