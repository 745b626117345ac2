#include "bag/run_hash.hpp"

#include "base/error.hpp"
#include "report/recording.hpp"
#include "runtime/recorded_messages.hpp"

namespace baton {
namespace {

std::uint64_t hashOf(const mcap::MessageView& view) { return dds::chainHash(0, view.data); }

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

HashedRun hashRun(const mcap::FileList& file) { return hashRun(mcap::JoinedReader(file), file); }

HashedRun hashRun(const mcap::JoinedReader& reader, const mcap::FileList& file) {
  expectTopic(reader, dds::topics::kPlantState.name, file);
  const std::uint64_t begin_ns = lastTakeBegin(reader);
  HashedRun run;
  forEachMessageOf(dds::topics::kPlantState, reader, begin_ns, [&](const msg::PlantState& state, const auto& view) {
    HashedRun::Step& step = run.steps[state.step()];
    step.hashes.state = hashOf(view);
    step.chain = state.chain_hash();
    step.holder = state.holder().c_str();
  });
  if (run.steps.empty()) throw UsageError(file.string() + ": expected the states of a run, found none");
  forEachMessageOf(dds::topics::kContact, reader, begin_ns, [&](const msg::Contact& contact, const auto& view) {
    if (const auto step = run.steps.find(contact.step()); step != run.steps.end())
      step->second.hashes.contact = hashOf(view);
  });
  forEachMessageOf(dds::topics::kReference, reader, begin_ns, [&](const msg::Reference& reference, const auto& view) {
    if (const auto step = run.steps.find(reference.step()); step != run.steps.end())
      step->second.reference = hashOf(view);
  });
  forEachMessageOf(
      dds::topics::kJointCommand, reader, begin_ns, [&](const msg::JointCommand& command, const auto& view) {
        const auto step = run.steps.find(command.step());
        if (step == run.steps.end()) return;
        // At the first step of a new holder the outgoing one commands as well.
        dds::StepHashes& hashes = step->second.hashes;
        (step->second.holder == command.controller().c_str() ? hashes.command : hashes.outgoing_command) = hashOf(view);
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
