#include "recorded_files.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "dds/topics.hpp"
#include "mcap/writer.hpp"
#include "runtime/ledger.hpp"
#include "runtime/paths.hpp"
#include "runtime/scenario.hpp"
#include "runtime/service_options.hpp"

namespace baton::test {
namespace {

template <class T>
std::vector<std::byte> encoded(const T& message) {
  std::vector<std::byte> buffer(dds::maxPayload<T>());
  const auto payload = dds::encode(message, buffer);
  return {payload.begin(), payload.end()};
}

struct Stream {
  std::string service;
  Ledger::Key key;  // of its samples; its manifest is by the same writer
  std::uint64_t count = 0;
  std::uint64_t hash = 0;
  std::mt19937_64 noise{7};

  std::vector<std::byte> send() {
    // As of an arm that moves: what does not repeat are the last digits.
    std::uniform_real_distribution<double> digits(0.0, 1e-9);
    const double t = 1e-3 * static_cast<double>(++count);
    msg::PlantState state;
    state.step(count);
    state.time_ns(static_cast<std::int64_t>(count) * 1'000'000);
    for (const double frequency : {1.0, 1.7, 2.3}) {
      state.position().push_back(std::sin(frequency * t) + digits(noise));
      state.velocity().push_back(frequency * std::cos(frequency * t) + digits(noise));
      state.applied_effort().push_back(std::sin(frequency * t) * std::cos(t) + digits(noise));
    }
    state.holder("pd");
    state.chain_hash(noise());
    std::vector<std::byte> payload = encoded(state);
    hash = dds::chainHash(hash, payload);
    return payload;
  }
  [[nodiscard]] std::vector<std::byte> manifest(std::uint64_t first) const {
    msg::StreamManifest sent;
    sent.topic(key.first);
    sent.writer(key.second.bytes);
    sent.first_sequence(first);
    sent.last_sequence(first + count - 1);
    sent.count(count);
    sent.stream_hash(hash);
    msg::ServiceManifest manifest;
    manifest.name(service);
    manifest.streams().push_back(sent);
    return encoded(manifest);
  }
};

/// The files, one after another.
class Files {
 public:
  Files(std::filesystem::path folder, std::string name, const RecordingPlan& plan)
      : folder_(std::move(folder)), name_(std::move(name)), plan_(plan) {}

  mcap::Writer& begin(const Scenario& scenario) {
    const auto nameOf = [&](std::size_t index) {
      const std::string number = std::to_string(index);
      return name_ + (index == 0 ? "" : "_" + std::string(4 - number.size(), '0') + number) + ".mcap";
    };
    const std::string file = nameOf(names_.size());
    if (writer_) {
      writer_->addMetadata("baton.part_end", {{"next", file}});
      writer_->close();
    }
    channels_.clear();
    mcap::WriterOptions options;
    options.chunk_bytes = plan_.chunk_bytes;
    options.if_exists = mcap::OutputFile::IfExists::kReplace;
    options.sync_on_close = false;
    writer_ = std::make_unique<mcap::Writer>(folder_ / file, options);
    writer_->addMetadata("baton.run", {{"run", name_}, {"scenario", scenario.name}});
    writer_->addAttachment("scenario.yaml", "application/yaml", 0, 0, mcap::asBytes(scenario.text));
    writer_->addAttachment("robot.yaml", "application/yaml", 0, 0, mcap::asBytes(scenario.robot_text));
    if (plan_.parts > 1) {
      writer_->addMetadata("baton.part", {{"index", std::to_string(names_.size())},
                                          {"first", nameOf(0)},
                                          {"previous", names_.empty() ? "" : nameOf(names_.size() - 1)}});
    }
    names_.push_back((folder_ / file).string());
    return *writer_;
  }
  void write(const Ledger::Key& key, std::uint64_t sequence, mcap::ByteView payload,
             const mcap::StringMap& more_metadata = {}) {
    const auto [channel, is_new] = channels_.try_emplace(key);
    if (is_new) {
      mcap::StringMap metadata{{"writer", dds::toString(key.second)}, {"type", "T"}};
      metadata.insert(more_metadata.begin(), more_metadata.end());
      channel->second = writer_->addChannel(key.first, "cdr", mcap::kNoSchema, metadata);
    }
    ++time_ns_;
    writer_->write(channel->second, static_cast<std::uint32_t>(sequence), time_ns_, time_ns_, payload);
  }
  [[nodiscard]] mcap::Writer& writer() { return *writer_; }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  std::filesystem::path folder_;
  std::string name_;
  const RecordingPlan& plan_;
  std::unique_ptr<mcap::Writer> writer_;
  std::map<Ledger::Key, mcap::ChannelId> channels_;
  std::vector<std::string> names_;
  std::uint64_t time_ns_ = 0;
};

}  // namespace

std::vector<std::string> writeRecording(const std::filesystem::path& folder, const std::string& name,
                                        const RecordingPlan& plan) {
  const Scenario scenario = loadScenario((dataFolder() / "scenarios/link1.yaml").string());
  const std::vector<std::string> services = servicesBut(kRecorderName, scenario);
  Ledger ledger(services);
  ledger.remarkForeignTopics();
  Files files(folder, name, plan);
  std::vector<Stream> streams;
  for (const std::string& service : services) {
    dds::Guid guid;
    guid.bytes.fill(static_cast<std::uint8_t>(streams.size() + 1 + 16 * name.size()));  // another run has other writers
    streams.push_back({.service = service, .key = {dds::topics::kPlantState.name, guid}});
  }
  for (std::uint64_t i = 0; i < plan.samples; ++i) {
    if (i % (plan.samples / plan.parts) == 0) files.begin(scenario);
    for (Stream& stream : streams) {
      const std::uint64_t sequence = plan.first_sequence + i;
      std::vector<std::byte> payload = stream.send();
      const std::vector<std::byte> sent = payload;
      const bool is_first = &stream == &streams.front();
      if (is_first && plan.change == i + 1) payload[8] ^= std::byte{1};
      const bool is_there = !is_first || plan.leave_out != i + 1;
      if (is_there || !plan.is_seen) ledger.book(stream.key, sequence, plan.is_seen ? payload : sent);
      if (is_there) files.write(stream.key, sequence, payload);
      if (is_first && plan.repeat == i + 1) files.write(stream.key, sequence, payload);
    }
  }
  if (!plan.stranger.empty()) {
    const Ledger::Key key{plan.stranger, dds::Guid{}};
    const std::vector<std::byte> payload(16);
    for (const std::uint64_t sequence : {std::uint64_t{1}, 2 + plan.stranger_lost}) {
      ledger.book(key, sequence, payload);
      files.write(key, sequence, payload, {{"service", plan.claim}});
    }
  }
  for (const Stream& stream : streams) {
    if (stream.service == plan.silent) continue;
    const Ledger::Key key{dds::topics::kServiceManifest.name, stream.key.second};
    const std::vector<std::byte> manifest = stream.manifest(plan.first_sequence);
    ledger.book(key, 1, manifest);
    files.write(key, 1, manifest);
  }
  if (plan.dropped > 0) {
    const std::uint64_t first = plan.first_sequence + plan.samples;
    ledger.dropped(ledger.streamOf(streams.front().key), first, first + plan.dropped - 1);
  }
  if (plan.has_certificate) {
    files.writer().addMetadata("baton.certificate",
                               {{"complete", ledger.isComplete() ? "true" : "false"},
                                {"summary", ledger.isComplete() ? "complete" : "incomplete: " + ledger.problems()[0]}});
    files.writer().addAttachment("certificate.json", "application/json", 0, 0, mcap::asBytes(ledger.certificate()));
  }
  files.writer().close();
  return files.names();
}

}  // namespace baton::test
