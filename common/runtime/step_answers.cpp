#include "runtime/step_answers.hpp"

namespace baton {

Reading ContactAnswer::operator()(const msg::PlantState& state, msg::Contact& contact) {
  if (const Reading reading = fromMessage(state, joints_, state_); !reading) return reading;
  const Vector3 v_WE = state_.V_WE.head<3>();
  toMessage({state.step(), state.time_ns()}, planesContact(walls_, state_.X_WE.p, v_WE), contact);
  return {};
}

void ReferenceAnswer::operator()(std::uint64_t step, msg::Reference& message) {
  const StepStamp stamp = stampOf(step, step_ns_);
  trajectory_.evaluate(static_cast<double>(stamp.time_ns) * 1e-9, reference_);
  toMessage(stamp, reference_, message);
}

}  // namespace baton
