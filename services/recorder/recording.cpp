#include "recording.hpp"

#include <algorithm>
#include <span>

#include "dds/hash.hpp"
#include "mcap/repeated.hpp"
#include "msg/idl_text.hpp"
#include "runtime/recording_parts.hpp"

namespace baton {
namespace {

mcap::WriterOptions fileOptions(const RecordingConfig& config) {
  mcap::WriterOptions options;
  options.library = "baton " BATON_VERSION;
  options.chunk_bytes = config.chunk_bytes;
  options.compression = config.compression == "none"  ? mcap::Compression::kNone
                        : config.compression == "lz4" ? mcap::Compression::kLz4
                                                      : mcap::Compression::kZstd;
  options.compression_level = config.level;
  options.sync_chunks = config.sync_chunks;
  return options;
}

mcap::ByteView bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

/// A type we have no IDL for is kept as bytes. The specification's form for a schema that is not available is one
/// without encoding and without text: the name of the type is where every reader looks for it.
mcap::SchemaId addSchemaOf(const std::string& type, mcap::Writer& file) {
  for (const msg::IdlText& idl : msg::allIdlTexts()) {
    if (idl.type_name == type) return file.addSchema(type, "omgidl", bytesOf(idl.text));
  }
  return file.addSchema(type, "", {});
}

void attach(const Attachment& attachment, mcap::Writer& file) {
  file.addAttachment(attachment.name, attachment.media_type, 0, 0, bytesOf(attachment.text));
}

}  // namespace

Recording::Recording(std::filesystem::path path, const RecordingConfig& config, const Origin& origin,
                     std::uint64_t elapsed, std::uint64_t from_step, const Latched* latched)
    : path_(std::move(path)),
      config_(config),
      origin_(origin),
      file_(openPart(0, from_step)),
      latched_(latched),
      part_elapsed_(elapsed),
      from_step_(from_step) {
  parts_.push_back({.path = path_, .from_step = from_step, .shares = {}});
}

/// Metadata and attachments first: even a recording that is cut off says what it is of.
std::unique_ptr<mcap::Writer> Recording::openPart(unsigned index, std::uint64_t from_step) const {
  const std::filesystem::path path = partOf(path_, index);
  try {
    return openFile(path, index, from_step);
  } catch (const mcap::WriteError&) {
    // There was no room for its beginning, so nothing is in it: it would only be in the way.
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw;
  }
}

std::unique_ptr<mcap::Writer> Recording::openFile(const std::filesystem::path& path, unsigned index,
                                                  std::uint64_t from_step) const {
  auto file = std::make_unique<mcap::Writer>(path, fileOptions(config_));
  file->addMetadata("baton.run", origin_.run);
  if (config_.isSplit()) {
    file->addMetadata("baton.part", {{"index", std::to_string(index)},
                                     {"run", origin_.run.at("run")},
                                     {"first", path_.filename().string()},
                                     {"previous", index == 0 ? "" : partOf(path_, index - 1).filename().string()},
                                     {"from_step", std::to_string(from_step)}});
  }
  for (const Attachment& one : origin_.attachments) attach(one, *file);
  return file;
}

void Recording::write(const Stream& stream, const Sample& sample) {
  if (!std::exchange(has_begun_, true)) repeat(sample.log_time_ns);
  Written& written = writtenOf(stream);
  RecordedStream& recorded = written.recorded;
  const bool is_first = recorded.count == written.dropped;
  if (!is_first) recorded.missing += sample.lost_before;
  if (!written.is_here) begin(written, stream, sample);
  file_->write(written.channel, static_cast<std::uint32_t>(sample.sequence),
               static_cast<std::uint64_t>(sample.log_time_ns), static_cast<std::uint64_t>(sample.source_timestamp_ns),
               sample.payload);
  if (is_first) recorded.first_sequence = sample.sequence;
  ++recorded.count;
  recorded.last_sequence = sample.sequence;
  // As long as nothing has been left out, the sum over what came is the sum over what is written.
  const ReceivedStream& received = stream.received->second;
  recorded.hash =
      recorded.count == received.count ? received.stream_hash : dds::chainHash(recorded.hash, sample.payload);
  ++messages_;
}

Recording::Written& Recording::writtenOf(const Stream& stream) {
  if (stream.index >= written_.size()) written_.resize(stream.index + 1);
  return written_[stream.index];
}

void Recording::openChannel(Written& written, const Stream& stream) {
  if (written.channel != mcap::ChannelId{}) return;
  written.channel = file_->addChannel(stream.topic(), "cdr", addSchemaOf(stream.type, *file_), stream.metadata);
}

/// What a late joiner would be given now: the part alone says how things stood when it began.
void Recording::repeat(std::int64_t log_time_ns) {
  repeated_ = {};
  if (latched_ == nullptr || latched_->size() == 0) return;
  file_->addMetadata(mcap::kRepeatedRecord, mcap::repeatedRecord(latched_->size()));
  file_->flush();  // before them: a file that is cut after their chunk still says what they are
  latched_->forEach([&](const Latched::Sample& sample) {
    Written& written = writtenOf(*sample.head.stream);
    openChannel(written, *sample.head.stream);
    file_->write(written.channel, static_cast<std::uint32_t>(sample.head.sequence),
                 static_cast<std::uint64_t>(log_time_ns), static_cast<std::uint64_t>(sample.head.source_timestamp_ns),
                 sample.bytes);
  });
  file_->flush();
  repeated_ = file_->statistics();
}

/// The first sample of a stream in this part.
void Recording::begin(Written& written, const Stream& stream, const Sample& sample) {
  written.is_here = true;
  written.stream = &stream;
  openChannel(written, stream);
  if (!config_.drops_oldest) return;
  parts_.back().shares.push_back({.stream = stream.index,
                                  .first_sequence = sample.sequence,
                                  .count_before = written.recorded.count,
                                  .missing_before = written.recorded.missing,
                                  .hash_before = written.recorded.hash});
}

void Recording::splitWhenFull(std::uint64_t elapsed, std::uint64_t step) {
  // What a part begins with, scenario, robot and what it repeats, fills none.
  const mcap::WriterStatistics so_far = file_->statistics();
  const std::uint64_t bytes = so_far.chunks > repeated_.chunks ? so_far.file_bytes - repeated_.file_bytes : 0;
  if (!isPartFull(config_, bytes, elapsed - part_elapsed_)) return;
  // The next one first: without it this one goes on.
  std::unique_ptr<mcap::Writer> next = openPart(index_ + 1, step);
  try {
    file_->addMetadata("baton.part_end", {{"next", partOf(path_, index_ + 1).filename().string()}});
    closeFile();
  } catch (const mcap::WriteError&) {
    // There was room for the beginning of the next one, and none for the end of this one: this one is the last.
    next->discard();
    throw;
  }
  file_ = std::move(next);
  ++index_;
  parts_.push_back({.path = partOf(path_, index_), .from_step = step, .messages_before = messages_, .shares = {}});
  part_elapsed_ = elapsed;
  for (Written& written : written_) {
    written.channel = {};
    written.is_here = false;
  }
  has_begun_ = false;
  repeated_ = {};
}

std::uint64_t Recording::writtenMessages() const {
  if (!file_) return messages_;
  const mcap::WriterStatistics statistics = file_->statistics();
  // The latest ones are unwritten: a part begins with what it repeats.
  const std::uint64_t own = messages_ - parts_.back().messages_before;
  return messages_ - std::min(own, statistics.messages - statistics.written_messages);
}

void Recording::closeFile() {
  file_->close();
  parts_.back().bytes = file_->statistics().file_bytes;
  closed_bytes_ += parts_.back().bytes;
}

Storage Recording::storage() const {
  const mcap::WriterStatistics file = file_->statistics();
  return {.closed_bytes = closed_bytes_,
          .part_bytes = file.file_bytes,
          .declared_bytes = file.declared_bytes,
          .closed_parts = parts_.size() - 1};
}

/// The account of each stream begins anew where the next part has the first of it.
void Recording::dropOldestPart() {
  const Part oldest = std::move(parts_.front());
  parts_.pop_front();
  std::error_code gone_already;
  std::filesystem::remove(oldest.path, gone_already);
  closed_bytes_ -= oldest.bytes;
  for (const Share& share : oldest.shares) {
    Written& written = written_[share.stream];
    const Share* first = nullptr;
    for (const Part& part : parts_) {
      const auto found = std::find_if(part.shares.begin(), part.shares.end(),
                                      [&](const Share& one) { return one.stream == share.stream; });
      if (found == part.shares.end()) continue;
      first = &*found;
      break;
    }
    RecordedStream& recorded = written.recorded;
    written.dropped = first != nullptr ? first->count_before : recorded.count;
    written.dropped_missing = first != nullptr ? first->missing_before : recorded.missing;
    recorded.hash_seed = first != nullptr ? first->hash_before : recorded.hash;
    recorded.first_sequence = first != nullptr ? first->first_sequence : 0;
  }
  if (!dropped_) dropped_ = Hole{.from_step = oldest.from_step, .reason = "the oldest parts made room"};
  dropped_->to_step = parts_.front().from_step;
  dropped_->samples += parts_.front().messages_before - oldest.messages_before;
}

void Recording::finish(Certificate& certificate, std::uint64_t to_step, const std::vector<Hole>& holes,
                       const std::vector<Attachment>& attachments) {
  std::vector<std::string> names;
  for (const Part& part : parts_) names.push_back(part.path.filename().string());
  for (const Written& written : written_) {
    if (written.stream == nullptr) continue;
    RecordedStream recorded = written.recorded;
    recorded.count -= written.dropped;
    recorded.missing -= written.dropped_missing;
    certificate.add(*written.stream, recorded);
  }
  certificate.setParts(std::move(names), index_ + 1 - static_cast<unsigned>(parts_.size()));
  std::vector<Hole> all = holes;
  if (dropped_) all.insert(all.begin(), *dropped_);
  certificate.setHoles(std::move(all));
  certificate.setSteps(from_step_, to_step);
  for (const Attachment& one : attachments) attach(one, *file_);
  file_->addMetadata("baton.certificate",
                     {{"complete", certificate.isComplete() ? "true" : "false"}, {"summary", certificate.summary()}});
  file_->addAttachment("certificate.json", "application/json", 0, 0, bytesOf(certificate.text()));
  closeFile();
  file_.reset();
}

}  // namespace baton
