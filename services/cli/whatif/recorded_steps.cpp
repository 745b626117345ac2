#include "recorded_steps.hpp"

#include <algorithm>
#include <map>
#include <span>

#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "dds/topics.hpp"
#include "messages/loop.hpp"

namespace baton {
namespace {

constexpr std::uint64_t kWindow = 8192;          // steps
constexpr std::uint64_t kProgressEvery = 10000;  // messages

/// Puts messages together that belong to one step.
class Gatherer {
 public:
  Gatherer(int n, const std::function<void(const RecordedStep&)>& f) : n_(n), f_(f) {}

  void operator()(const msg::PlantState& message, const mcap::MessageView& view) {
    RecordedInput<RobotState> state{{}, dds::chainHash(0, view.data)};
    RecordedStep* step = at(message.step());
    if (step == nullptr || step->state || !fromMessage(message, n_, state.value)) return;
    step->log_time_ns = view.log_time_ns;
    step->publish_time_ns = view.publish_time_ns;
    step->chain_hash = message.chain_hash();
    step->holder = message.holder().c_str();
    step->state = state;
  }
  void operator()(const msg::Reference& message, const mcap::MessageView& view) {
    RecordedInput<Reference> reference{{}, dds::chainHash(0, view.data)};
    RecordedStep* step = at(message.step());
    if (step != nullptr && !step->reference && fromMessage(message, n_, reference.value)) step->reference = reference;
  }
  void operator()(const msg::Contact& message, const mcap::MessageView& view) {
    RecordedInput<Contact> contact{{}, dds::chainHash(0, view.data)};
    RecordedStep* step = at(message.step());
    if (step != nullptr && !step->contact && fromMessage(message, contact.value)) step->contact = contact;
  }
  void operator()(const msg::JointCommand& message, const mcap::MessageView& /*view*/) {
    RecordedStep* step = at(message.step());
    if (step == nullptr) return;
    RecordedCommand command{message.controller().c_str(), {}, message.inputs_hash()};
    if (JointVector effort; fromMessage(message, n_, effort)) command.effort = effort;
    step->commands.push_back(std::move(command));
  }

  void finish() {
    while (!steps_.empty()) take();
  }

 private:
  /// Nothing for a step that has been handed on already.
  RecordedStep* at(std::uint64_t step) {
    if (step < next_) return nullptr;
    RecordedStep& found = steps_[step];
    found.step = step;
    while (steps_.rbegin()->first - steps_.begin()->first > kWindow) take();
    return step < next_ ? nullptr : &steps_.at(step);
  }

  void take() {
    const auto first = steps_.begin();
    RecordedStep& step = first->second;
    if (step.state) {
      const auto after = steps_.find(step.step + 1);
      if (after != steps_.end() && after->second.state) step.felt = after->second.state->value.tau_applied;
      f_(step);
    }
    next_ = step.step + 1;
    steps_.erase(first);
  }

  int n_;
  const std::function<void(const RecordedStep&)>& f_;
  std::map<std::uint64_t, RecordedStep> steps_;
  std::uint64_t next_ = 0;
};

}  // namespace

const RecordedCommand* RecordedStep::commandOfHolder() const {
  const auto found =
      std::find_if(commands.begin(), commands.end(), [&](const auto& command) { return command.controller == holder; });
  return found == commands.end() ? nullptr : &*found;
}

const std::optional<JointVector>* RecordedStep::effort() const {
  if (holder.empty()) return &felt;
  const RecordedCommand* command = commandOfHolder();
  return command == nullptr ? nullptr : &command->effort;
}

std::uint64_t RecordedStep::inputsHash(bool uses_force) const {
  const std::array<std::uint64_t, 3> hashes{state ? state->hash : 0, reference ? reference->hash : 0,
                                            contact ? contact->hash : 0};
  return dds::inputsHash(std::span(hashes).first(uses_force ? 3 : 2));
}

void forEachStep(const mcap::Source& reader, std::uint64_t begin_ns, int n,
                 const std::function<void(const RecordedStep&)>& f, const std::function<void(double)>& progress) {
  Gatherer gather(n, f);
  const auto read = [&]<class M>(const mcap::MessageView& view, const dds::Topic<M>& topic) {
    M message;
    if (view.channel->topic == topic.name && dds::decode(view.data, message)) gather(message, view);
  };
  using namespace dds::topics;
  const std::vector<std::string> topics{kPlantState.name, kReference.name, kContact.name, kJointCommand.name};
  std::uint64_t total = 0, count = 0;
  for (const auto& [id, messages] : reader.statistics().channel_message_counts) {
    const std::string& topic = reader.channels().at(id).topic;
    if (std::find(topics.begin(), topics.end(), topic) != topics.end()) total += messages;
  }
  reader.forEachMessage({.topics = topics, .start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile},
                        [&](const mcap::MessageView& view) {
                          read(view, kPlantState);
                          read(view, kReference);
                          read(view, kContact);
                          read(view, kJointCommand);
                          if (progress && ++count % kProgressEvery == 0 && total > 0)
                            progress(static_cast<double>(count) / static_cast<double>(total));
                        });
  gather.finish();
}

}  // namespace baton
