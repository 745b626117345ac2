/// Scenario files: what a recording is to hold, and how it is kept on the disk.
#include <cmath>

#include "runtime/scenario_parts.hpp"

namespace baton {
namespace {

constexpr double kMega = 1e6;
constexpr double kMost_MB = 1e9;  // a million times a million

std::uint64_t readMegabytes(const YamlMap& map, const char* key, double least_MB, std::uint64_t otherwise) {
  const auto node = map.find(key);
  return node ? static_cast<std::uint64_t>(std::llround(node->number({least_MB, kMost_MB, "MB"}) * kMega)) : otherwise;
}

std::uint64_t readStepsOr(const YamlMap& map, const char* key, const Scenario& scenario) {
  const auto node = map.find(key);
  if (!node) return 0;
  const std::uint64_t steps = readSteps(*node, scenario);
  if (steps == 0) node->refuse("at least one step");
  return steps;
}

std::vector<std::string> readPatterns(const YamlMap& map, const char* key) {
  constexpr std::size_t kMostPatterns = 64;
  std::vector<std::string> patterns;
  const auto node = map.find(key);
  if (!node) return patterns;
  for (const YamlNode& one : node->list(1, kMostPatterns)) {
    patterns.push_back(one.text());
    if (patterns.back().empty()) one.refuse("the name of a topic, or a pattern such as *_status");
  }
  return patterns;
}

void readCompressionLevel(const YamlMap& map, RecordingConfig& recording) {
  const auto node = map.find("level");
  if (!node) return;
  if (recording.compression == "none") node->fail("expected no level where there is no compression");
  recording.level = static_cast<int>(node->integer(-100, recording.compression == "zstd" ? 22 : 12));
}

/// What only makes sense beside something else.
void requireTogether(const YamlMap& map, const RecordingConfig& recording) {
  if (recording.ring_steps > 0) {
    for (const char* key : {"split_MB", "split_s", "start", "max_MB", "when_full"}) {
      if (const auto node = map.find(key)) node->fail("expected no such thing beside ring_s: a ring is in memory");
    }
  } else if (const auto node = map.find("ring_MB")) {
    node->fail("expected ring_s beside it, how many seconds are to be kept");
  }
  if (const auto node = map.find("when_full")) {
    if (!map.has("max_MB") && !map.has("min_free_MB")) {
      node->fail("expected max_MB or min_free_MB beside it, at which something is full");
    }
    if (recording.drops_oldest && !recording.isSplit())
      node->fail("expected split_MB or split_s beside it: only parts are dropped");
  }
  // The file's own index comes on top of its chunks, and the first part has to be whole before a second one can begin.
  if (recording.max_bytes > 0 && recording.max_bytes < 4 * recording.chunk_bytes) {
    map["max_MB"].fail("expected at least four chunks (chunk_kB)");
  }
  if (recording.split_bytes > 0 && recording.split_bytes < recording.chunk_bytes) {
    map["split_MB"].fail("expected at least a chunk (chunk_kB)");
  }
  if (recording.drops_oldest && recording.split_bytes > 0 && recording.max_bytes > 0 &&
      recording.max_bytes < 2 * recording.split_bytes) {
    map["max_MB"].fail("expected room for two parts (split_MB) at least");
  }
}

}  // namespace

const std::vector<std::string>& recordingShapeKeys() {
  static const std::vector<std::string> kKeys{"level",   "chunk_kB",  "start",      "topics", "except",
                                              "foreign", "split_MB",  "split_s",    "ring_s", "ring_MB",
                                              "max_MB",  "when_full", "min_free_MB"};
  return kKeys;
}

void readRecordingShape(const YamlMap& map, const Scenario& scenario, RecordingConfig& recording) {
  readCompressionLevel(map, recording);
  constexpr std::int64_t kLeastChunk_kB = 1, kMostChunk_kB = 64'000;
  if (map.has("chunk_kB")) {
    recording.chunk_bytes = static_cast<std::size_t>(1000 * map["chunk_kB"].integer(kLeastChunk_kB, kMostChunk_kB));
  }
  if (const auto start = map.find("start")) {
    recording.starts_stopped = start->oneOf<bool>({{"at_once", false}, {"on_request", true}});
  }
  recording.topics = readPatterns(map, "topics");
  recording.except = readPatterns(map, "except");
  if (const auto foreign = map.find("foreign")) recording.takes_foreign = foreign->boolean();
  constexpr double kLeast_MB = 0.001;
  recording.split_bytes = readMegabytes(map, "split_MB", kLeast_MB, 0);
  recording.split_steps = readStepsOr(map, "split_s", scenario);
  recording.ring_steps = readStepsOr(map, "ring_s", scenario);
  recording.ring_bytes = readMegabytes(map, "ring_MB", kLeast_MB, recording.ring_bytes);
  recording.max_bytes = readMegabytes(map, "max_MB", kLeast_MB, 0);
  recording.min_free_bytes = readMegabytes(map, "min_free_MB", 0.0, recording.min_free_bytes);
  if (const auto full = map.find("when_full")) {
    recording.drops_oldest = full->oneOf<bool>({{"stop", false}, {"drop_oldest", true}});
  }
  requireTogether(map, recording);
}

}  // namespace baton
