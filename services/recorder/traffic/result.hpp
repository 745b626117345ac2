/// The result of a recording of traffic: as text, as JSON, as an exit code.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "traffic/options.hpp"

namespace baton {

enum class TrafficEnd {
  kSignal,   // by a person or a machine that goes down
  kReached,  // what was asked for: a duration, a number, a size
  kTooEarly  // the disk is full, or the file cannot be written
};

struct TrafficResult {
  struct Topic {
    std::string name;
    std::string type;
    std::uint64_t messages = 0;
    std::uint64_t lost = 0;
    std::size_t writers = 0;
  };
  struct Loss {
    std::string topic;
    std::string writer;
    std::string service;  // of Baton's; empty: of another program
    std::uint64_t lost = 0;
  };
  std::vector<std::string> files;  // the parts, in order
  TrafficEnd end = TrafficEnd::kSignal;
  std::string ended;    // why, in words
  std::string summary;  // the certificate's verdict
  bool is_complete = false;
  double seconds = 0.0;
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  std::vector<Topic> topics;
  std::vector<Loss> losses;            // by writer, the largest first
  std::vector<std::string> problems;   // writers that could not be read
  std::vector<std::string> left_out;   // topics, on purpose
  std::vector<std::string> unmatched;  // patterns of topics
};

/// A signal is the ordinary end of a recording that was to last until then; of one that was to have an end
/// it is an interruption.
[[nodiscard]] ExitCode exitCodeOf(const TrafficResult& result, const TrafficOptions& options);
[[nodiscard]] std::string textOf(const TrafficResult& result, const TrafficOptions& options);
[[nodiscard]] std::string jsonOf(const TrafficResult& result, const TrafficOptions& options);

}  // namespace baton
