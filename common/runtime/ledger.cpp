#include "runtime/ledger.hpp"

#include <algorithm>
#include <utility>

#include "dds/codec.hpp"
#include "dds/hash.hpp"
#include "dds/topics.hpp"
#include "runtime/json.hpp"

namespace baton {

bool Ledger::book(Stream& booked, std::uint64_t sequence, std::span<const std::byte> payload) {
  ReceivedStream& stream = booked.second;
  if (stream.count > 0 && sequence <= stream.last_sequence) return false;
  if (stream.count == 0) {
    stream.first_sequence = sequence;
  } else {
    stream.missing += sequence - stream.last_sequence - 1;
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

void Ledger::addManifest(const msg::ServiceManifest& manifest) { manifests_.push_back(manifest); }

bool Ledger::hasManifestOf(const std::string& service) const {
  return std::any_of(manifests_.begin(), manifests_.end(),
                     [&](const msg::ServiceManifest& manifest) { return service == manifest.name().c_str(); });
}

std::vector<std::string> Ledger::unvouched() const {
  // Only on topics that the run's own services count: operators come and go without a manifest.
  std::set<std::string> counted;
  std::set<Key> vouched;
  for (const msg::ServiceManifest& manifest : manifests_) {
    for (const msg::StreamManifest& sent : manifest.streams()) {
      if (services_.contains(manifest.name().c_str())) counted.insert(sent.topic().c_str());
      vouched.insert({sent.topic().c_str(), dds::Guid{sent.writer()}});
    }
  }
  std::vector<std::string> result;
  for (const auto& [key, stream] : streams_) {
    if (counted.contains(key.first) && !vouched.contains(key)) {
      result.push_back(key.first + ": a writer that ended without a manifest, nobody vouches for its " +
                       std::to_string(stream.count) + " samples");
    }
  }
  return result;
}

std::uint64_t Ledger::missing() const {
  std::uint64_t total = 0;
  for (const auto& [key, stream] : streams_) {
    if (!dds::isStatusTopic(key.first)) total += stream.missing;
  }
  return total;
}

std::vector<std::string> Ledger::problemsOf(const msg::ServiceManifest& manifest) const {
  std::vector<std::string> result;
  for (const msg::StreamManifest& sent : manifest.streams()) {
    const std::string topic = sent.topic().c_str();
    const auto found = streams_.find({topic, dds::Guid{sent.writer()}});
    const ReceivedStream received = found == streams_.end() ? ReceivedStream{} : found->second;
    const std::string what = topic + " of " + manifest.name().c_str();
    if (received.count != sent.count()) {
      result.push_back(what + ": " + std::to_string(sent.count()) + " samples sent, " + std::to_string(received.count) +
                       " recorded");
    } else if (received.stream_hash != sent.stream_hash()) {
      result.push_back(what + ": the recorded bytes are not those sent");
    }
  }
  return result;
}

std::vector<std::string> Ledger::problems() const {
  std::vector<std::string> result;
  for (const std::string& service : services_) {
    if (!hasManifestOf(service)) result.push_back(service + " sent no manifest");
  }
  for (const msg::ServiceManifest& manifest : manifests_) {
    for (std::string& problem : problemsOf(manifest)) result.push_back(std::move(problem));
  }
  for (std::string& problem : unvouched()) result.push_back(std::move(problem));
  if (dropped_ > 0) result.push_back(std::to_string(dropped_) + " samples came faster than they could be written");
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

std::string Ledger::certificate() const {
  nlohmann::ordered_json streams = nlohmann::ordered_json::array();
  for (const auto& [key, stream] : streams_) {
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
    streams.push_back(std::move(row));
  }
  const std::vector<std::string> found = problems();
  const nlohmann::ordered_json text{{"complete", found.empty()}, {"problems", found}, {"streams", streams}};
  return toText(text);
}

std::vector<std::string> Ledger::disagreements(const std::string& certificate_text) const {
  using Json = nlohmann::json;
  std::vector<std::string> result;
  const auto rowsOf = [](const Json& certificate) {
    std::map<std::pair<std::string, std::string>, Json> rows;
    for (const Json& row : certificate.at("streams")) rows[{row.at("topic"), row.at("writer")}] = row;
    return rows;
  };
  try {
    const Json theirs = Json::parse(certificate_text), ours = Json::parse(certificate());
    auto their_rows = rowsOf(theirs);
    for (const auto& [key, row] : rowsOf(ours)) {
      const std::string what = key.first + " of writer " + key.second;
      const Json their_row = std::exchange(their_rows[key], {});
      if (their_row.is_null()) result.push_back("the certificate does not know " + what);
      for (const auto& [field, value] : row.items()) {
        if (their_row.is_null() || their_row.value(field, Json()) == value) continue;
        result.push_back("the certificate says otherwise of " + what + ": " + field + " " +
                         their_row.value(field, Json()).dump() + ", the bytes give " + value.dump());
        break;
      }
    }
    for (const auto& [key, row] : their_rows) {
      if (!row.is_null())
        result.push_back("the certificate knows " + key.first + " of writer " + key.second + ", which is not there");
    }
    if (theirs.at("complete").get<bool>() && !isComplete())
      result.emplace_back("the certificate says complete, the bytes do not");
  } catch (const Json::exception& error) {
    result.push_back(std::string("the certificate cannot be read: ") + error.what());
  }
  return result;
}

}  // namespace baton
