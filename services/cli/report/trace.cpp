#include "trace.hpp"

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "recording.hpp"
#include "robot/kinematics.hpp"
#include "runtime/recorded_messages.hpp"

namespace baton {
namespace {

/// The steps from the first recorded state to the last.
struct Stretch {
  std::uint64_t first = 0;
  Eigen::Index steps = 0;
};

/// Throws UsageError when there are no states, or when their step numbers cannot be those of a run: a file from
/// elsewhere may have any.
Stretch statesIn(const mcap::Source& reader, std::uint64_t begin_ns, std::int64_t step_ns, const mcap::FileList& file) {
  expectTopic(reader, dds::topics::kPlantState.name, file);
  std::uint64_t count = 0, first = 0, last = 0;
  forEachMessageOf(dds::topics::kPlantState, reader, begin_ns, [&](const msg::PlantState& state, const auto&) {
    first = count == 0 ? state.step() : std::min(first, state.step());
    last = std::max(last, state.step());
    ++count;
  });
  if (count == 0) throw UsageError(file.string() + ": expected states of a plant, found none");
  constexpr std::uint64_t kMostMissing = 10;  // times what is there
  if ((last - first) / kMostMissing > count) {
    throw UsageError(file.string() + ": expected the states of one stretch of a run, found " + std::to_string(count) +
                     " of the steps from " + std::to_string(first) + " to " + std::to_string(last));
  }
  if (last > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max() / step_ns)) {
    throw UsageError(file.string() + ": expected steps that have a time in ns, found step " + std::to_string(last) +
                     " of " + std::to_string(step_ns) + " ns");
  }
  return {first, static_cast<Eigen::Index>(last - first) + 1};
}

/// Fills a trace from the messages of the loop: states first, then the rest. What a service would refuse counts as not
/// recorded.
class TraceFiller {
 public:
  TraceFiller(Trace& trace, Eigen::Index steps)
      : trace_(trace), R_WE_(static_cast<std::size_t>(steps), Matrix3::Zero()) {
    const auto make = [&](Eigen::MatrixXd& matrix, Eigen::Index rows) {
      matrix = Eigen::MatrixXd::Constant(rows, steps, std::numeric_limits<double>::quiet_NaN());
    };
    for (Eigen::MatrixXd* joints : {&trace.q, &trace.qd, &trace.tau, &trace.q_d, &trace.qd_d, &trace.qdd_d})
      make(*joints, trace.scenario.robot.size());
    for (Eigen::MatrixXd* three : {&trace.p_WE, &trace.p_WE_d, &trace.orientation, &trace.zyz, &trace.zyz_d})
      make(*three, 3);
    for (Eigen::MatrixXd* six : {&trace.V_WE_d, &trace.A_WE_d, &trace.h_e, &trace.h_d}) make(*six, 6);
    trace.chain.resize(static_cast<std::size_t>(steps));
  }

  void operator()(const msg::PlantState& message) {
    const Eigen::Index k = column(message.step());
    RobotState state;
    if (k < 0 || !fromMessage(message, trace_.scenario.robot.size(), state)) return;
    trace_.q.col(k) = state.q;
    trace_.qd.col(k) = state.qd;
    trace_.tau.col(k) = state.tau_applied;
    trace_.p_WE.col(k) = state.X_WE.p;
    trace_.zyz.col(k) = zyzFromRotation(state.X_WE.R);
    R_WE_[static_cast<std::size_t>(k)] = state.X_WE.R;
    trace_.chain[static_cast<std::size_t>(k)] = message.chain_hash();
  }
  void operator()(const msg::Reference& message) {
    const Eigen::Index k = column(message.step());
    Reference reference;
    if (k < 0 || !fromMessage(message, trace_.scenario.robot.size(), reference)) return;
    if (reference.q.size() > 0) {
      trace_.q_d.col(k) = reference.q;
      trace_.qd_d.col(k) = reference.qd;
      trace_.qdd_d.col(k) = reference.qdd;
    }
    if (!reference.has_task) return;
    trace_.p_WE_d.col(k) = reference.X_WE.p;
    trace_.zyz_d.col(k) = zyzFromRotation(reference.X_WE.R);
    trace_.V_WE_d.col(k) = reference.V_WE;
    trace_.A_WE_d.col(k) = reference.A_WE;
    trace_.h_d.col(k) = reference.h_d;
    const Matrix3& R_WE = R_WE_[static_cast<std::size_t>(k)];
    if (!R_WE.isZero(0.0)) trace_.orientation.col(k) = rotationVector(reference.X_WE.R * R_WE.transpose());
  }
  void operator()(const msg::Contact& message) {
    const Eigen::Index k = column(message.step());
    Contact contact;
    if (k >= 0 && fromMessage(message, contact)) trace_.h_e.col(k) = contact.h_e;
  }
  void operator()(const msg::SwapOutcome& outcome) {
    if (outcome.done()) trace_.swaps.push_back(outcome);
  }
  void operator()(const msg::SimStatus& status) { trace_.missed_steps = status.missed_steps(); }

 private:
  /// The column of a step; -1 for one before the first state or after the last.
  [[nodiscard]] Eigen::Index column(std::uint64_t step) const {
    const std::uint64_t k = step - trace_.first_step;  // of an earlier step: a large number
    return k < static_cast<std::uint64_t>(trace_.steps()) ? static_cast<Eigen::Index>(k) : -1;
  }

  Trace& trace_;
  std::vector<Matrix3> R_WE_;  // zero where no state was recorded
};

/// Reads the messages of these topics in one pass over the file.
template <class... T>
void read(const mcap::Source& reader, std::uint64_t begin_ns, TraceFiller& filler, const dds::Topic<T>&... topics) {
  const auto fill = [&]<class M>(const dds::Topic<M>& topic, const mcap::MessageView& view) {
    M message;
    if (view.channel->topic == topic.name && dds::decode(view.data, message)) filler(message);
  };
  reader.forEachMessage(
      {.topics = {topics.name...}, .start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile},
      [&](const mcap::MessageView& view) { (fill(topics, view), ...); });
}

}  // namespace

Trace readTrace(const mcap::FileList& file) {
  const mcap::JoinedReader reader(file);
  Trace trace;
  trace.scenario = recordedScenario(reader, file);
  trace.is_complete = isCertified(reader);
  trace.info = reader.info();
  const std::uint64_t begin_ns = lastTakeBegin(reader);
  const Stretch stretch = statesIn(reader, begin_ns, trace.scenario.step_ns, file);
  trace.first_step = stretch.first;
  TraceFiller filler(trace, stretch.steps);
  read(reader, begin_ns, filler, dds::topics::kPlantState);
  read(reader, begin_ns, filler, dds::topics::kReference, dds::topics::kContact, dds::topics::kSwapOutcome,
       dds::topics::kSimStatus);
  if (trace.q.array().isNaN().all())
    throw UsageError(file.string() + ": expected states of its robot, found those of another");
  return trace;
}

}  // namespace baton
