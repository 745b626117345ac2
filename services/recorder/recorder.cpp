#include "recorder.hpp"

#include <fnmatch.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cstring>
#include <nlohmann/json.hpp>

#include "msg/idl_text.hpp"
#include "run_manifest.hpp"
#include "runtime/paths.hpp"

namespace baton {
namespace {

constexpr std::size_t kQueueBytes = std::size_t{256} << 20;
constexpr std::size_t kChunkBytes = std::size_t{256} << 10;  // of larger ones the file gains 1 %, the process 2 MB
constexpr auto kIdle = std::chrono::milliseconds(10);        // how long a sample may wait before it is written
constexpr auto kFlush = std::chrono::seconds(1);             // what a killed recorder may take along
constexpr auto kManifestPatience = std::chrono::seconds(5);  // for what is still on its way when the run has ended

mcap::WriterOptions fileOptions(const RecordingConfig& config) {
  mcap::WriterOptions options;
  options.library = "baton " BATON_VERSION;
  options.chunk_bytes = kChunkBytes;
  options.compression = config.compression == "none"  ? mcap::Compression::kNone
                        : config.compression == "lz4" ? mcap::Compression::kLz4
                                                      : mcap::Compression::kZstd;
  options.sync_chunks = config.sync_chunks;
  return options;
}

mcap::ByteView bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

/// The step a payload of the loop belongs to: its first member, behind the encapsulation header.
std::uint64_t stepOf(std::span<const std::byte> payload) {
  std::uint64_t step = 0;
  if (payload.size() < 12) return 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const bool little_endian = (payload[1] & std::byte{1}) != std::byte{0};
    const std::size_t at = 4 + (little_endian ? 7 - i : i);
    step = (step << 8) | std::to_integer<std::uint64_t>(payload[at]);
  }
  return step;
}

}  // namespace

Recorder::Recorder(Service& service)
    : service_(service),
      file_(service.options().out, fileOptions(service.scenario().recording)),
      queue_(kQueueBytes, 1024),
      ledger_(servicesBut(kRecorderName, service.scenario())),
      status_out_(service.output(dds::topics::kRecorderStatus, {kPlantName})),
      rewind_ack_out_(service.output(dds::topics::kRewindAck, {kPlantName})) {
  const Scenario& scenario = service.scenario();
  // Not the commands: while the brake holds there are none. A writer remembers more steps than the credit, so they are
  // safe.
  loop_steps_ = {{dds::topics::kPlantState.name, 0}, {dds::topics::kReference.name, 0}};
  if (scenario.hasEnvironment()) loop_steps_[dds::topics::kContact.name] = 0;
  // Metadata and attachments first: even a recording that is cut off says what it is of.
  file_.addMetadata("baton.run", runManifest(service.options(), scenario));
  file_.addAttachment("scenario.yaml", "application/yaml", 0, 0, bytesOf(scenario.text));
  file_.addAttachment("robot.yaml", "application/yaml", 0, 0, bytesOf(scenario.robot_text));
  if (const std::string& checkpoint = service.options().checkpoint; !checkpoint.empty()) {
    file_.addAttachment("checkpoint.mcap", "application/octet-stream", 0, 0, bytesOf(readFile(checkpoint)));
  }
  requireServices();
  service.answersNoSteps();
  service.onEnd([this] { has_run_ended_ = true; });
  service.participant().watchWriters([this](const dds::DiscoveredWriter& writer) {
    boost::asio::post(service_.executor(), [this, writer] { writerFound(writer); });
  });
  file_thread_ = std::thread([this] { writeFile(); });
}

Recorder::~Recorder() {
  service_.participant().watchWriters({});  // those of other cells come and go while this one ends
  queue_.close();
  if (file_thread_.joinable()) file_thread_.join();
  topics_.clear();  // their callbacks use what is declared after them
}

ExitCode Recorder::run() {
  service_.run();
  queue_.close();
  file_thread_.join();
  return result_;
}

// --- executor
// ---------------------------------------------------------------------------------------------------------

void Recorder::requireServices() {
  const Scenario& scenario = service_.scenario();
  const std::vector<std::string> controllers = controllerNames(scenario);
  const auto require = [this](const auto& topic, const std::vector<std::string>& writers) {
    const std::string name = topic.name;
    service_.require(
        name,
        [this, name] {
          const std::lock_guard lock(topics_mutex_);
          std::set<dds::GuidPrefix> matched;
          for (const auto& known : topics_) {
            if (known->options.topic == name) matched.merge(known->reader->matched());
          }
          return matched;
        },
        writers);
  };
  require(dds::topics::kPlantState, {kPlantName});
  require(dds::topics::kRewind, {kPlantName});
  require(dds::topics::kSwapPlan, {kPlantName});
  require(dds::topics::kSwapOutcome, {kPlantName});
  require(dds::topics::kSwapReport, {kPlantName});
  require(dds::topics::kDecision, {kPlantName});
  require(dds::topics::kReference, {kTrajectoryName});
  if (scenario.hasEnvironment()) require(dds::topics::kContact, {kEnvironmentName});
  require(dds::topics::kJointCommand, controllers);
  require(dds::topics::kShadowCommand, controllers);
  require(dds::topics::kSwapAck, controllers);
  require(dds::topics::kCheckpoint, {kPlantName});  // controllers that have checkpoints wait for us themselves
  require(dds::topics::kEvent, servicesBut(kRecorderName, scenario));
  require(dds::topics::kServiceManifest, servicesBut(kRecorderName, scenario));
}

void Recorder::writerFound(const dds::DiscoveredWriter& writer) {
  // A writer's partition may be a pattern, as DDS has it.
  const std::string partition = service_.options().participant().partition;
  const bool is_ours = std::any_of(writer.partitions.begin(), writer.partitions.end(), [&](const std::string& theirs) {
    return fnmatch(theirs.c_str(), partition.c_str(), 0) == 0;
  });
  if (!is_ours) return;
  const dds::EndpointOptions options{.topic = writer.topic,
                                     .type = writer.type,
                                     .profile = writer.transient_local ? dds::Profile::kEvent : dds::Profile::kLoop,
                                     .keyed = writer.keyed,
                                     .exclusive_ownership = writer.exclusive_ownership,
                                     .best_effort = !writer.reliable};
  const std::lock_guard lock(topics_mutex_);
  const std::optional<dds::Peer> peer = service_.participant().peer(dds::prefixOf(writer.guid));
  writer_facts_[writer.guid] = {peer ? peer->service : "", writer.qos_text};
  const auto known =
      std::find_if(topics_.begin(), topics_.end(), [&](const auto& topic) { return topic->options == options; });
  const auto index = static_cast<std::uint32_t>(known - topics_.begin());
  {
    const std::lock_guard route_lock(routes_mutex_);
    routes_[writer.guid] = index;
  }
  if (known != topics_.end()) return;
  if (std::any_of(topics_.begin(), topics_.end(),
                  [&](const auto& topic) { return topic->options.topic == writer.topic; }))
    has_rivals_ = true;
  auto topic = std::make_unique<Topic>();
  topic->options = options;
  try {
    topic->reader = std::make_unique<dds::RawReader>(
        service_.participant(), options,
        [this, index, own = dds::prefixOf(status_out_.raw().guid())](const dds::RawSample& sample) {
          if (dds::prefixOf(sample.writer) == own || !isFor(index, sample.writer)) return;
          if (!queue_.push(index, sample)) ++dropped_;
        },
        [this] { service_.matchesChanged(); });
  } catch (const Error& error) {
    return service_.event(msg::SEVERITY_ERROR, "record", error.what());
  }
  topics_.push_back(std::move(topic));
}

bool Recorder::isFor(std::uint32_t topic, const dds::Guid& writer) {
  if (!has_rivals_) return true;
  const std::lock_guard lock(routes_mutex_);
  const auto found = routes_.find(writer);
  return found == routes_.end() || found->second == topic;
}

// --- file thread
// ------------------------------------------------------------------------------------------------------

mcap::StringMap Recorder::channelMetadata(const dds::Guid& writer) const {
  const auto found = writer_facts_.find(writer);
  const WriterFacts facts = found == writer_facts_.end() ? WriterFacts{} : found->second;
  return {{"writer", dds::toString(writer)}, {"service", facts.service}, {"qos", facts.qos}};
}

mcap::ChannelId Recorder::channelOf(const SampleQueue::Entry& entry, const Topic& topic) {
  const auto found = channels_.find({topic.options.topic, entry.writer});
  if (found != channels_.end()) return found->second;
  const auto texts = msg::allIdlTexts();
  const auto idl =
      std::find_if(texts.begin(), texts.end(), [&](const auto& text) { return text.type_name == topic.options.type; });
  // A type we have no IDL for is kept as bytes under its name.
  const mcap::SchemaId schema =
      idl == texts.end() ? mcap::kNoSchema : file_.addSchema(topic.options.type, "omgidl", bytesOf(idl->text));
  mcap::StringMap metadata = channelMetadata(entry.writer);
  metadata["type"] = topic.options.type;
  const mcap::ChannelId channel = file_.addChannel(topic.options.topic, "cdr", schema, metadata);
  channels_[{topic.options.topic, entry.writer}] = channel;
  return channel;
}

void Recorder::writeBatch(const SampleQueue::Batch& batch) {
  const std::lock_guard lock(topics_mutex_);
  for (const SampleQueue::Entry& entry : batch.entries) {
    const Topic& topic = *topics_[entry.topic];
    const auto payload = batch.payload(entry);
    if (!ledger_.book({topic.options.topic, entry.writer}, entry.sequence, payload)) continue;
    if (!dds::isStatusTopic(topic.options.topic)) ++progress_;
    file_.write(channelOf(entry, topic), static_cast<std::uint32_t>(entry.sequence),
                static_cast<std::uint64_t>(entry.log_time_ns), static_cast<std::uint64_t>(entry.source_timestamp_ns),
                payload);
    if (const auto loop = loop_steps_.find(topic.options.topic); loop != loop_steps_.end()) {
      loop->second = std::max(loop->second, stepOf(payload));
    } else if (topic.options.topic == dds::topics::kRewind.name) {
      msg::Rewind rewind;
      if (dds::decode(payload, rewind)) onRewind(rewind);
    }
  }
}

void Recorder::onRewind(const msg::Rewind& rewind) {
  owed_.reset();
  if (rewind.phase() == msg::REWIND_CANCEL) return;
  if (rewind.phase() == msg::REWIND_COMMIT) {
    take_ = rewind.take();
    for (auto& [topic, step] : loop_steps_) step = 0;
    published_ = 0;
  }
  owed_ = rewind;
}

/// The file has everything up to the open step, or has begun a new take: the plant waits to hear so.
void Recorder::answerRewind() {
  if (!owed_ || (owed_->phase() == msg::REWIND_PREPARE && acknowledged_ < owed_->at_step())) return;
  msg::RewindAck ack;
  ack.take(owed_->take());
  ack.phase(owed_->phase());
  ack.name(kRecorderName);
  rewind_ack_out_.write(ack);
  owed_.reset();
}

void Recorder::acknowledge(bool is_idle) {
  acknowledged_ = std::min_element(loop_steps_.begin(), loop_steps_.end(), [](const auto& a, const auto& b) {
                    return a.second < b.second;
                  })->second;
  service_.at(acknowledged_);
  const std::uint64_t credit = service_.scenario().recording.credit_steps;
  const bool is_due = acknowledged_ >= published_ + std::max<std::uint64_t>(1, credit / 8);
  if (is_due || (is_idle && acknowledged_ != published_)) {
    published_ = acknowledged_;
    publishStatus(msg::RECORDER_RECORDING, "");
  }
  answerRewind();
}

void Recorder::publishStatus(msg::RecorderState state, const std::string& text) {
  const mcap::WriterStatistics statistics = file_.statistics();
  msg::RecorderStatus status;
  status.state(state);
  status.take(take_);
  status.acknowledged_step(acknowledged_);
  status.messages(statistics.written_messages);
  status.bytes(statistics.file_bytes);
  status.lost(ledger_.missing() + dropped_);
  status.complete(state == msg::RECORDER_CLOSED && result_ == ExitCode::kOk);
  status.path(service_.options().out);
  status.text(text.substr(0, 199));
  status_out_.write(status);
}

void Recorder::writeFile() {
  try {
    SampleQueue::Batch batch;
    std::chrono::steady_clock::time_point ended{};
    std::uint64_t progress = 0;
    std::chrono::steady_clock::time_point flushed = std::chrono::steady_clock::now();
    const std::chrono::duration<double> sync(service_.scenario().recording.sync_s);
    std::chrono::steady_clock::time_point synced = flushed;
    publishStatus(msg::RECORDER_RECORDING, "");
    while (queue_.take(batch, kIdle)) {
      writeBatch(batch);
      acknowledge(batch.entries.empty());
      const auto now = std::chrono::steady_clock::now();
      if (now - flushed > kFlush) {
        file_.flush();
        flushed = now;
        publishStatus(msg::RECORDER_RECORDING, "");
      }
      if (sync.count() > 0.0 && now - synced > sync) {
        file_.sync();
        synced = std::chrono::steady_clock::now();
      }
      if (!has_run_ended_) continue;
      const bool is_first = ended == std::chrono::steady_clock::time_point{};
      if (is_first || progress_ != progress) ended = now;  // as long as something comes, more may
      progress = progress_;
      if (ledger_.isSettled() || now - ended > kManifestPatience) break;
    }
    finishFile();
  } catch (const std::exception& error) {
    // What is in the file up to here stays readable; nobody in the loop may wait for more.
    result_ = ExitCode::kFailed;
    spdlog::error("recording failed: {}", error.what());
    acknowledged_ = ~std::uint64_t{0} >> 1;
    try {
      publishStatus(msg::RECORDER_FAILED, error.what());
    } catch (const std::exception&) {
    }
    service_.event(msg::SEVERITY_ERROR, "record", std::string("recording failed: ") + error.what());
  }
  service_.stop(result_);
}

void Recorder::finishFile() {
  ledger_.dropped(dropped_);
  const std::vector<std::string> problems = ledger_.problems();
  const bool is_complete = problems.empty();
  const std::string summary = is_complete ? "complete" : "incomplete: " + problems.front();
  file_.addMetadata("baton.certificate", {{"complete", is_complete ? "true" : "false"}, {"summary", summary}});
  file_.addAttachment("certificate.json", "application/json", 0, 0, bytesOf(ledger_.certificate()));
  file_.close();
  result_ = is_complete ? ExitCode::kOk : ExitCode::kFailed;
  const mcap::WriterStatistics statistics = file_.statistics();
  spdlog::info("closed path={} messages={} bytes={} {}", service_.options().out, statistics.messages,
               statistics.file_bytes, summary);
  for (const std::string& problem : problems) spdlog::warn("incomplete: {}", problem);
  publishStatus(msg::RECORDER_CLOSED, summary);
  status_out_.raw().waitForAcknowledgments(1000);
}

}  // namespace baton
