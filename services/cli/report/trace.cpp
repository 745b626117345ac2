#include "trace.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "recording.hpp"
#include "robot/kinematics.hpp"

namespace baton {
namespace {

std::string attachment(const mcap::Reader& reader, const std::string& name, const std::filesystem::path& file) {
  if (std::optional<std::string> text = attachmentText(reader, name)) return std::move(*text);
  throw UsageError(file.string() + ": expected the recording of a run, with its " + name + ", found none");
}

/// How many states there are, and the step of the first.
std::pair<std::uint64_t, std::uint64_t> statesIn(const mcap::Reader& reader, std::uint64_t begin_ns) {
  std::uint64_t count = 0, first = 0;
  reader.forEachMessage({.topics = {dds::topics::kPlantState.name},
                         .start_time_ns = begin_ns,
                         .order = mcap::MessageFilter::Order::kFile},
                        [&](const mcap::MessageView& view) {
                          msg::PlantState state;
                          if (!dds::decode(view.data, state)) return;
                          first = count == 0 ? state.step() : std::min(first, state.step());
                          ++count;
                        });
  return {count, first};
}

Eigen::Quaterniond toEigen(const msg::Quaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }

/// Fills a trace from the messages of the loop.
class Filler {
 public:
  Filler(Trace& trace, Eigen::Index steps) : trace_(trace), desired_(static_cast<std::size_t>(steps)) {
    const Eigen::Index n = trace.scenario.robot.size();
    const auto make = [&](Eigen::MatrixXd& matrix, Eigen::Index rows) {
      matrix = Eigen::MatrixXd::Constant(rows, steps, std::numeric_limits<double>::quiet_NaN());
    };
    for (Eigen::MatrixXd* joints :
         {&trace.q, &trace.qd, &trace.tau, &trace.command, &trace.q_d, &trace.qd_d, &trace.qdd_d})
      make(*joints, n);
    for (Eigen::MatrixXd* three : {&trace.p_WE, &trace.p_WE_d, &trace.orientation, &trace.zyz, &trace.zyz_d})
      make(*three, 3);
    make(trace.h_d, 6);
    trace.h_e = Eigen::MatrixXd::Zero(6, steps);
    trace.holders.resize(static_cast<std::size_t>(steps));
    trace.chain.resize(static_cast<std::size_t>(steps));
    actual_.resize(static_cast<std::size_t>(steps));
  }

  void operator()(const msg::PlantState& state) {
    const Eigen::Index k = column(state.step());
    if (k < 0) return;
    fill(state.position(), trace_.q, k);
    fill(state.velocity(), trace_.qd, k);
    fill(state.applied_effort(), trace_.tau, k);
    fill(state.tip_position(), trace_.p_WE, k);
    actual_[static_cast<std::size_t>(k)] = toEigen(state.tip_orientation());
    trace_.zyz.col(k) = zyzFromRotation(actual_[static_cast<std::size_t>(k)].toRotationMatrix());
    trace_.holders[static_cast<std::size_t>(k)] = state.holder().c_str();
    trace_.chain[static_cast<std::size_t>(k)] = state.chain_hash();
  }
  void operator()(const msg::Reference& reference) {
    const Eigen::Index k = column(reference.step());
    if (k < 0) return;
    fill(reference.position(), trace_.q_d, k);
    fill(reference.velocity(), trace_.qd_d, k);
    fill(reference.acceleration(), trace_.qdd_d, k);
    if (!reference.has_task()) return;
    fill(reference.tip_position(), trace_.p_WE_d, k);
    desired_[static_cast<std::size_t>(k)] = toEigen(reference.tip_orientation());
    trace_.zyz_d.col(k) = zyzFromRotation(desired_[static_cast<std::size_t>(k)]->toRotationMatrix());
    for (int i = 0; i < 3; ++i) {
      trace_.h_d(i, k) = reference.force()[static_cast<std::size_t>(i)];
      trace_.h_d(3 + i, k) = reference.moment()[static_cast<std::size_t>(i)];
    }
  }
  void operator()(const msg::Contact& contact) {
    const Eigen::Index k = column(contact.step());
    if (k < 0) return;
    for (int i = 0; i < 3; ++i) {
      trace_.h_e(i, k) = contact.force()[static_cast<std::size_t>(i)];
      trace_.h_e(3 + i, k) = contact.moment()[static_cast<std::size_t>(i)];
    }
  }
  void operator()(const msg::JointCommand& command) {
    const Eigen::Index k = column(command.step());
    // At the first step of a handover the outgoing controller commands as well.
    if (k >= 0 && trace_.holders[static_cast<std::size_t>(k)] == command.controller().c_str())
      fill(command.effort(), trace_.command, k);
  }
  void operator()(const msg::SwapOutcome& outcome) {
    if (outcome.done()) trace_.swaps.push_back(outcome);
  }
  void operator()(const msg::SimStatus& status) { trace_.missed_steps = status.missed_steps(); }

  void finish() {
    for (Eigen::Index k = 0; k < trace_.steps(); ++k) {
      const auto& desired = desired_[static_cast<std::size_t>(k)];
      if (!desired) continue;
      trace_.orientation.col(k) =
          rotationVector((*desired * actual_[static_cast<std::size_t>(k)].conjugate()).normalized().toRotationMatrix());
    }
  }

 private:
  /// The column of a step; -1 for one that the file cannot have, or that comes after the last state.
  [[nodiscard]] Eigen::Index column(std::uint64_t step) const {
    const std::uint64_t k = step - trace_.first_step;  // of an earlier step: a large number
    return k < static_cast<std::uint64_t>(trace_.q.cols()) ? static_cast<Eigen::Index>(k) : -1;
  }
  template <class Numbers>
  static void fill(const Numbers& numbers, Eigen::MatrixXd& matrix, Eigen::Index k) {
    if (static_cast<Eigen::Index>(numbers.size()) != matrix.rows()) return;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) matrix(i, k) = numbers[static_cast<std::size_t>(i)];
  }

  Trace& trace_;
  std::vector<std::optional<Eigen::Quaterniond>> desired_;
  std::vector<Eigen::Quaterniond> actual_;
};

/// Reads the messages of these topics in one pass over the file.
template <class... T>
void read(const mcap::Reader& reader, std::uint64_t begin_ns, Filler& filler, const dds::Topic<T>&... topics) {
  const auto fill = [&]<class M>(const dds::Topic<M>& topic, const mcap::MessageView& view) {
    M message;
    if (view.channel->topic == topic.name && dds::decode(view.data, message)) filler(message);
  };
  reader.forEachMessage(
      {.topics = {topics.name...}, .start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile},
      [&](const mcap::MessageView& view) { (fill(topics, view), ...); });
}

}  // namespace

Trace readTrace(const std::filesystem::path& file) {
  const mcap::Reader reader(file);
  Trace trace;
  const std::string robot_text = attachment(reader, "robot.yaml", file);
  trace.scenario = parseScenario(file.string() + "#scenario.yaml", attachment(reader, "scenario.yaml", file),
                                 file.string() + "#robot.yaml", robot_text);
  trace.is_complete = isCertified(reader);
  const std::uint64_t begin_ns = lastTakeBegin(reader);
  const auto [steps, first_step] = statesIn(reader, begin_ns);
  trace.first_step = first_step;
  if (steps == 0) throw UsageError(file.string() + ": expected states of a plant, found none");
  Filler filler(trace, static_cast<Eigen::Index>(steps));
  read(reader, begin_ns, filler, dds::topics::kPlantState);  // first: whose command counts is what the states say
  read(reader, begin_ns, filler, dds::topics::kReference, dds::topics::kContact, dds::topics::kJointCommand,
       dds::topics::kSwapOutcome, dds::topics::kSimStatus);
  filler.finish();
  return trace;
}

}  // namespace baton
