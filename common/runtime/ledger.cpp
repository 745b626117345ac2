#include "runtime/ledger.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/plural.hpp"
#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "dds/topics.hpp"
#include "runtime/json.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {

/// Whether samples may be missing there. Of a status only the latest word counts. An operator asks as fast as it likes
/// and may be gone before a request is sent again; its consequences are on the topics of the services.
bool mayLack(const std::string& topic) {
  const dds::TopicFacts* facts = dds::topics::called(topic);
  return dds::isStatusTopic(topic) || (facts != nullptr && facts->written_by == dds::WrittenBy::kOperators);
}

}  // namespace

bool Ledger::book(Stream& booked, std::uint64_t sequence, std::span<const std::byte> payload) {
  ReceivedStream& stream = booked.second;
  if (sequence <= stream.last_sequence) return false;
  if (stream.count == 0 && stream.missing == 0) {
    stream.first_sequence = sequence;
  } else if (sequence > stream.last_sequence + 1) {
    note(booked, stream.last_sequence + 1, sequence - 1, "never came");
  }
  stream.last_sequence = sequence;
  ++stream.count;
  stream.stream_hash = dds::chainHash(stream.stream_hash, payload);
  read(booked.first.first, payload);
  return true;
}

void Ledger::read(const std::string& topic, std::span<const std::byte> payload) {
  if (topic == dds::topics::kServiceManifest.name) {
    msg::ServiceManifest manifest;
    if (dds::decode(payload, manifest)) addManifest(manifest);
  } else if (topic == dds::topics::kServiceStatus.name) {
    msg::ServiceStatus status;
    if (!dds::decode(payload, status)) return;
    if (status.state() == msg::SERVICE_FAILED) giveUpOn(status.name().c_str());
    if (status.state() == msg::SERVICE_READY && status.role() == "controller") expect(status.name().c_str());
  }
}

void Ledger::dropped(Stream& booked, std::uint64_t first_sequence, std::uint64_t last_sequence) {
  ReceivedStream& stream = booked.second;
  first_sequence = std::max(first_sequence, stream.last_sequence + 1);
  if (last_sequence < first_sequence) return;
  if (stream.count == 0 && stream.missing == 0) {
    stream.first_sequence = first_sequence;
  } else if (first_sequence > stream.last_sequence + 1) {
    note(booked, stream.last_sequence + 1, first_sequence - 1, "never came");
  }
  note(booked, first_sequence, last_sequence, "came faster than it could be written");
  stream.dropped += last_sequence - first_sequence + 1;
  stream.last_sequence = last_sequence;
}

void Ledger::passOver(Stream& booked, std::uint64_t first_sequence, std::uint64_t last_sequence) {
  ReceivedStream& stream = booked.second;
  if (last_sequence <= stream.last_sequence) return;
  const bool has_begun = stream.count + stream.missing > 0;
  if (has_begun && first_sequence > stream.last_sequence + 1) {
    note(booked, stream.last_sequence + 1, first_sequence - 1, "never came");
  }
  stream.last_sequence = last_sequence;
}

void Ledger::note(Stream& stream, std::uint64_t first_sequence, std::uint64_t last_sequence, const char* reason) {
  stream.second.missing += last_sequence - first_sequence + 1;
  // Others must not fill the list.
  const std::size_t most = isRemarked(stream.first.first) ? kMaxGaps / 2 : kMaxGaps;
  if (mayLack(stream.first.first) || gaps_.size() >= most) return;
  gaps_.push_back({stream.first, first_sequence, last_sequence, reason});
}

void Ledger::addManifest(const msg::ServiceManifest& manifest) { manifests_.push_back(manifest); }

bool Ledger::hasManifestOf(const std::string& service) const {
  return std::any_of(manifests_.begin(), manifests_.end(),
                     [&](const msg::ServiceManifest& manifest) { return service == manifest.name().c_str(); });
}

std::size_t Ledger::servicesHeard() const {
  std::set<std::string> names;
  for (const msg::ServiceManifest& manifest : manifests_) names.insert(manifest.name().c_str());
  names.erase(kSecondCopyName);
  return names.size();
}

std::set<Ledger::Key> Ledger::vouchedFor() const {
  std::set<Key> result;
  for (const msg::ServiceManifest& manifest : manifests_) {
    for (const msg::StreamManifest& sent : manifest.streams()) {
      result.insert({sent.topic().c_str(), dds::Guid{sent.writer()}});
    }
  }
  return result;
}

std::vector<std::string> Ledger::unvouched(const std::set<Key>& vouched) const {
  // Only on topics that the run's own services count: operators come and go without a manifest.
  std::set<std::string> listed;
  for (const msg::ServiceManifest& manifest : manifests_) {
    if (!services_.contains(manifest.name().c_str())) continue;
    for (const msg::StreamManifest& sent : manifest.streams()) listed.insert(sent.topic().c_str());
  }
  std::vector<std::string> result;
  for (const auto& [key, stream] : streams_) {
    if (stream.count + stream.missing == 0 || left_out_.contains(key.first)) continue;
    if (listed.contains(key.first) && !vouched.contains(key)) {
      result.push_back(key.first + ": a writer that ended without a manifest, nobody vouches for its " +
                       counted(stream.count, "sample"));
    }
  }
  return result;
}

std::uint64_t Ledger::missing() const {
  std::uint64_t total = 0;
  for (const auto& [key, stream] : streams_) {
    if (!mayLack(key.first) && !isRemarked(key.first)) total += stream.missing;
  }
  return total;
}

std::vector<std::string> Ledger::problemsOf(const msg::ServiceManifest& manifest) const {
  std::vector<std::string> result;
  for (const msg::StreamManifest& sent : manifest.streams()) {
    const std::string topic = sent.topic().c_str();
    if (left_out_.contains(topic)) continue;
    const auto found = streams_.find({topic, dds::Guid{sent.writer()}});
    ReceivedStream received = found == streams_.end() ? ReceivedStream{} : found->second;
    if (const auto told = testimonies_.find({topic, dds::Guid{sent.writer()}}); told != testimonies_.end()) {
      received.count = told->second.count;
      received.stream_hash = told->second.hash;
      received.excused = told->second.excused;
    }
    const std::string what = topic + " of " + manifest.name().c_str();
    if (received.count + received.excused != sent.count()) {
      result.push_back(what + ": " + counted(sent.count(), "sample") + " sent, " + std::to_string(received.count) +
                       " recorded");
    } else if (received.excused == 0 && received.stream_hash != sent.stream_hash()) {
      result.push_back(what + ": the recorded bytes are not those sent");
    }
  }
  return result;
}

std::vector<std::string> Ledger::problems() const {
  if (is_excerpt_) return problemsSoFar();
  std::vector<std::string> result;
  for (const std::string& service : services_) {
    if (!hasManifestOf(service)) result.push_back(service + " sent no manifest");
  }
  for (const msg::ServiceManifest& manifest : manifests_) {
    for (std::string& problem : problemsOf(manifest)) result.push_back(std::move(problem));
  }
  const std::set<Key> vouched = vouchedFor();
  for (std::string& problem : unvouched(vouched)) result.push_back(std::move(problem));
  for (std::string& problem : lossesOf(Concern::kVerdict, vouched)) result.push_back(std::move(problem));
  return result;
}

std::vector<std::string> Ledger::problemsSoFar() const { return lossesOf(Concern::kVerdict, {}); }

std::vector<std::string> Ledger::remarks() const { return lossesOf(Concern::kRemark, {}); }

bool Ledger::isRemarked(const std::string& topic) const { return are_foreign_remarked_ && dds::isForeignTopic(topic); }

/// What is missing of streams other than these, of which is known already, and what cannot be recorded.
std::vector<std::string> Ledger::lossesOf(Concern concern, const std::set<Key>& but) const {
  std::vector<std::string> result;
  for (const auto& [topic, what] : unrecordable_) {
    if (concernOf(topic) == concern) result.push_back(what);
  }
  if (concern == Concern::kVerdict) {
    result.insert(result.end(), lacks_.begin(), lacks_.end());
    std::uint64_t dropped = 0;
    for (const auto& [key, stream] : streams_) {
      if (stream.excused == 0 && !isRemarked(key.first)) dropped += stream.dropped;
    }
    if (dropped > 0)
      result.push_back(counted(dropped, "sample") + " came faster than " + (dropped == 1 ? "it" : "they") +
                       " could be written");
  }
  for (const auto& [key, stream] : streams_) {
    const std::uint64_t missing = stream.missing - std::min(stream.missing, stream.excused);
    if (missing == 0 || concernOf(key.first) != concern || mayLack(key.first)) continue;
    if (but.contains(key) || left_out_.contains(key.first)) continue;
    result.push_back(key.first + " of " + dds::toString(key.second) + ": " + counted(missing, "sample") + " " +
                     areOrIs(missing) + " missing");
  }
  return result;
}

bool Ledger::isSettled() const {
  for (const std::string& service : services_) {
    if (!hasManifestOf(service) && !given_up_.contains(service)) return false;
  }
  for (const msg::ServiceManifest& manifest : manifests_) {
    if (!problemsOf(manifest).empty()) return false;
  }
  return true;
}

nlohmann::ordered_json Ledger::rowOf(const Stream& booked) const {
  const auto& [key, stream] = booked;
  nlohmann::ordered_json row{{"topic", key.first},
                             {"writer", dds::toString(key.second)},
                             {"first_sequence", stream.first_sequence},
                             {"last_sequence", stream.last_sequence},
                             {"count", stream.count},
                             {"missing", stream.missing},
                             {"stream_hash", std::to_string(stream.stream_hash)}};
  for (const msg::ServiceManifest& manifest : manifests_) {
    for (const msg::StreamManifest& sent : manifest.streams()) {
      if (key != Key{sent.topic().c_str(), dds::Guid{sent.writer()}}) continue;
      row["service"] = manifest.name().c_str();
      row["sent"] = sent.count();
      row["sent_hash"] = std::to_string(sent.stream_hash());
    }
  }
  return row;
}

std::string Ledger::certificate() const {
  nlohmann::ordered_json streams = nlohmann::ordered_json::array();
  for (const Stream& stream : streams_) streams.push_back(rowOf(stream));
  const std::vector<std::string> found = problems();
  const nlohmann::ordered_json text{{"complete", found.empty()}, {"problems", found}, {"streams", streams}};
  return toText(text);
}

namespace {
using Json = nlohmann::json;

/// Calls back with each row of a certificate and its stream; what cannot be read is left to compare().
template <class Callback>
void forEachRow(const std::string& certificate, const Callback& callback) {
  const Json json = Json::parse(certificate, nullptr, false);
  if (!json.is_object()) return;
  try {
    for (const Json& row : json.at("streams")) {
      const auto writer = dds::guidCalled(row.at("writer").get<std::string>());
      if (writer) callback(row, Ledger::Key{row.at("topic").get<std::string>(), *writer});
    }
  } catch (const std::exception&) {
    return;
  }
}

std::uint64_t numberIn(const Json& row, const char* key) {
  const std::string text = row.value(key, "0");
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace

void Ledger::beginAt(const std::string& certificate) {
  forEachRow(certificate, [this](const Json& row, const Key& key) {
    if (row.contains("hash_seed")) streamOf(key).second.stream_hash = numberIn(row, "hash_seed");
  });
}

void Ledger::excuse(const std::string& certificate) {
  const Json json = Json::parse(certificate, nullptr, false);
  if (!json.is_object()) return;
  try {
    for (const Json& topic : json.value("left_out", Json::array())) leaveOut(topic.get<std::string>());
    is_excerpt_ = !json.value("run_is_over", true) || left_out_.contains(dds::topics::kServiceManifest.name);
  } catch (const Json::exception&) {
    return;
  }
  forEachRow(certificate, [this](const Json& row, const Key& key) {
    if (row.contains("received")) {
      testimonies_[key] = {.count = row.at("received").get<std::uint64_t>(),
                           .hash = numberIn(row, "received_hash"),
                           .excused = row.value("lost_before", std::uint64_t{0})};
    }
    if (const auto found = streams_.find(key); found != streams_.end()) {
      found->second.missing -= std::min(found->second.missing, row.value("left_out", std::uint64_t{0}));
    }
  });
}

void Ledger::compareRows(const Json& theirs, Comparison& comparison) const {
  const auto rowsOf = [](const Json& certificate) {
    std::map<std::pair<std::string, std::string>, Json> rows;
    for (const Json& row : certificate.at("streams")) rows[{row.at("topic"), row.at("writer")}] = row;
    return rows;
  };
  const auto say = [&](const std::string& topic, const std::string& text) {
    (isRemarked(topic) ? comparison.remarks : comparison.disagreements).push_back(text);
  };
  auto their_rows = rowsOf(theirs);
  for (const auto& [key, row] : rowsOf(Json::parse(certificate()))) {
    const auto& [topic, writer] = key;
    const std::string what = topic + " of writer " + writer;
    const Json their_row = std::exchange(their_rows[key], {});
    if (their_row.is_null()) {
      say(topic, "the certificate does not know " + what);
      continue;
    }
    if (row.at("count") > 0 &&
        their_row.value("lost_before", std::uint64_t{0}) >= row.at("first_sequence").get<std::uint64_t>()) {
      say(topic, "the certificate says of " + what + " that more was lost before its first sample than there was");
    }
    for (const auto& [field, value] : row.items()) {
      const Json their_value = their_row.value(field, Json());
      if (their_value == value) continue;
      say(topic, "the certificate says otherwise of " + what + ": " + field + " " + their_value.dump() +
                     ", the bytes give " + value.dump());
      break;
    }
  }
  for (const auto& [key, row] : their_rows) {
    if (row.is_null() || row.value("count", std::uint64_t{0}) == 0) continue;
    say(key.first, "the certificate knows " + key.first + " of writer " + key.second + ", which is not there");
  }
}

Ledger::Comparison Ledger::compare(const std::string& certificate_text) const {
  Comparison result;
  try {
    const Json theirs = Json::parse(certificate_text);
    if (theirs.contains("remarks")) {
      result.remarks = theirs.at("remarks").get<std::vector<std::string>>();
    } else {
      result.remarks = remarks();
    }
    compareRows(theirs, result);
    if (theirs.at("complete").get<bool>() && !isComplete())
      result.disagreements.emplace_back("the certificate says complete, the bytes do not");
  } catch (const Json::exception& error) {
    result.disagreements.push_back(std::string("the certificate cannot be read: ") + error.what());
  }
  return result;
}

}  // namespace baton
