#include "bag_hash.hpp"

#include "base/error.hpp"
#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/reader.hpp"
#include "report/recording.hpp"

namespace baton {
namespace {

/// Calls f(message, hash of its payload) for every message of the topic.
template <class T, class F>
void forEach(const mcap::Reader& reader, std::uint64_t begin_ns, const dds::Topic<T>& topic, const F& f) {
  T message;
  reader.forEachMessage({.topics = {topic.name}, .start_time_ns = begin_ns, .order = mcap::MessageFilter::Order::kFile},
                        [&](const mcap::MessageView& view) {
                          if (dds::decode(view.data, message)) f(message, dds::chainHash(0, view.data));
                        });
}

/// Whether the step's payloads, or some of them, give this hash.
bool gives(const HashedRun::Step& step, std::uint64_t next_chain) {
  for (unsigned left_out = 0; left_out < 8; ++left_out) {
    dds::StepHashes used = step.hashes;
    if ((left_out & 1U) != 0) used.contact = 0;
    if ((left_out & 2U) != 0) used.command = 0;
    if ((left_out & 4U) != 0) used.outgoing_command = 0;
    if (dds::chainStep(step.chain, used) == next_chain) return true;
  }
  return false;
}

}  // namespace

std::uint64_t HashedRun::hash() const { return steps.rbegin()->second.chain; }

std::optional<std::uint64_t> HashedRun::firstBroken() const {
  for (auto step = steps.begin(), next = std::next(step); next != steps.end(); step = next++) {
    if (next->first != step->first + 1 || !gives(step->second, next->second.chain)) return step->first;
  }
  return std::nullopt;
}

HashedRun hashRun(const std::filesystem::path& file) {
  const mcap::Reader reader(file);
  const std::uint64_t begin_ns = lastTakeBegin(reader);
  HashedRun run;
  forEach(reader, begin_ns, dds::topics::kPlantState, [&](const msg::PlantState& state, std::uint64_t hash) {
    HashedRun::Step& step = run.steps[state.step()];
    step.hashes.state = hash;
    step.chain = state.chain_hash();
    step.holder = state.holder().c_str();
  });
  if (run.steps.empty()) throw UsageError(file.string() + ": expected the states of a run, found none");
  forEach(reader, begin_ns, dds::topics::kContact, [&](const msg::Contact& contact, std::uint64_t hash) {
    if (const auto step = run.steps.find(contact.step()); step != run.steps.end()) step->second.hashes.contact = hash;
  });
  forEach(reader, begin_ns, dds::topics::kReference, [&](const msg::Reference& reference, std::uint64_t hash) {
    if (const auto step = run.steps.find(reference.step()); step != run.steps.end()) step->second.reference = hash;
  });
  forEach(reader, begin_ns, dds::topics::kJointCommand, [&](const msg::JointCommand& command, std::uint64_t hash) {
    const auto step = run.steps.find(command.step());
    if (step == run.steps.end()) return;
    // At the first step of a new holder the outgoing one commands as well.
    dds::StepHashes& hashes = step->second.hashes;
    (step->second.holder == command.controller().c_str() ? hashes.command : hashes.outgoing_command) = hash;
  });
  return run;
}

Comparison compare(const HashedRun& a, const HashedRun& b) {
  Comparison comparison;
  for (const auto& [number, one] : a.steps) {
    const auto found = b.steps.find(number);
    if (found == b.steps.end()) continue;
    ++comparison.steps;
    const dds::StepHashes &x = one.hashes, &y = found->second.hashes;
    const auto differ = [](std::uint64_t p, std::uint64_t q) { return p != 0 && q != 0 && p != q; };
    const bool commands_differ = differ(x.outgoing_command, y.outgoing_command) || differ(x.command, y.command);
    const char* topic = x.state != y.state                               ? dds::topics::kPlantState.name
                        : differ(x.contact, y.contact)                   ? dds::topics::kContact.name
                        : differ(one.reference, found->second.reference) ? dds::topics::kReference.name
                        : commands_differ                                ? dds::topics::kJointCommand.name
                                                                         : nullptr;
    if (topic == nullptr) continue;
    comparison.parting = Parting{number, topic};
    break;
  }
  return comparison;
}

}  // namespace baton
