#include "runtime/checkpoint.hpp"

#include <algorithm>
#include <set>

#include "mcap/writer.hpp"
#include "msg/idl_text.hpp"
#include "runtime/recorded_messages.hpp"

namespace baton {
namespace {

constexpr const char* kTopic = dds::topics::kCheckpoint.name;

}  // namespace

CheckpointSet newestCheckpoint(const mcap::FileList& recording, std::uint64_t begin_ns, std::uint64_t at_step,
                               const std::vector<std::string>& services) {
  const mcap::JoinedReader reader(recording);
  std::map<std::uint64_t, std::set<std::string>> parts;  // whose, by step
  const auto counts = [&](const msg::Checkpoint& one) {
    return one.step() <= at_step && std::find(services.begin(), services.end(), one.name().c_str()) != services.end();
  };
  forEachMessageOf(dds::topics::kCheckpoint, reader, begin_ns, [&](const msg::Checkpoint& one, const auto&) {
    if (counts(one)) parts[one.step()].insert(one.name().c_str());
  });
  const auto newest = std::find_if(parts.rbegin(), parts.rend(),
                                   [&](const auto& entry) { return entry.second.size() == services.size(); });
  CheckpointSet set;
  if (newest == parts.rend()) return set;
  set.step = newest->first;
  forEachMessageOf(dds::topics::kCheckpoint, reader, begin_ns, [&](const msg::Checkpoint& one, const auto&) {
    if (one.step() == set.step && counts(one)) set.states[one.name().c_str()] = one.state();
  });
  return set;
}

void writeCheckpoint(const std::filesystem::path& file, const CheckpointSet& set, std::int64_t step_ns) {
  mcap::Writer writer(file, {});
  const auto texts = msg::allIdlTexts();
  const auto idl = std::find_if(texts.begin(), texts.end(),
                                [](const auto& text) { return text.type_name == dds::topics::kCheckpoint.type; });
  const mcap::SchemaId schema =
      writer.addSchema(dds::topics::kCheckpoint.type, "omgidl", std::as_bytes(std::span(idl->text)));
  const mcap::ChannelId channel = writer.addChannel(kTopic, "cdr", schema, {});
  std::vector<std::byte> buffer(dds::maxPayload<msg::Checkpoint>());
  msg::Checkpoint message;
  message.step(set.step);
  message.time_ns(static_cast<std::int64_t>(set.step) * step_ns);
  std::uint32_t sequence = 0;
  for (const auto& [name, state] : set.states) {
    message.name(name);
    message.state() = state;
    writer.write(channel, ++sequence, 0, 0, dds::encode(message, std::span(buffer)));
  }
  writer.close();
}

CheckpointSet readCheckpoint(const std::filesystem::path& file) {
  const mcap::Reader reader(file);
  CheckpointSet set;
  forEachMessageOf(dds::topics::kCheckpoint, reader, 0, [&](const msg::Checkpoint& one, const auto&) {
    if (!set.states.empty() && one.step() != set.step) {
      throw UsageError(file.string() + ": expected the checkpoints of one step, found those of steps " +
                       std::to_string(set.step) + " and " + std::to_string(one.step()));
    }
    set.step = one.step();
    set.states[one.name().c_str()] = one.state();
  });
  if (set.states.empty()) throw UsageError(file.string() + ": expected checkpoints, found none");
  return set;
}

Checkpoints::Checkpoints(Service& service)
    : service_(service),
      from_(service.options().checkpoint.empty() ? CheckpointSet{} : readCheckpoint(service.options().checkpoint)),
      out_(service.output(dds::topics::kCheckpoint, withRecorder({}, service.scenario()))) {
  message_.name(service.options().name);
  message_.state().reserve(msg::MAX_CHECKPOINT);
}

void Checkpoints::publish(std::uint64_t step, const StateArchive& archive) {
  if (!archive.isGood()) {
    return service_.event(msg::SEVERITY_ERROR, "checkpoint", "the state is too large for a checkpoint");
  }
  const StepStamp stamp = service_.stampOf(step);
  message_.step(stamp.step);
  message_.time_ns(stamp.time_ns);
  message_.state().resize(archive.size());
  out_.write(message_);
}

void Checkpoints::refuse() const {
  throw UsageError(
      service_.options().checkpoint + ": expected the state of " + service_.options().name +
      " as this scenario and build have it, found another; a branch may change values, not laws or robots");
}

}  // namespace baton
