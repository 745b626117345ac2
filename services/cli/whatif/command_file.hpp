/// The efforts of a counterfactual as a recording of their own (MCAP), at the times of the steps they belong to, so
/// that any tool shows them beside the run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mcap/writer.hpp"
#include "msg/loop.h"
#include "recorded_steps.hpp"

namespace baton {

class CommandFile {
 public:
  static constexpr const char* kTopic = "whatif_command";
  static constexpr const char* kType = "baton::msg::JointCommand";

  /// Replaces a file that is there already, once it is closed. Throws UnavailableError.
  /// @param controller  what the commands call their author.  @param step_ns  length of a step.
  CommandFile(const std::filesystem::path& file, const std::string& controller, std::int64_t step_ns);
  ~CommandFile() { writer_.discard(); }
  CommandFile(const CommandFile&) = delete;
  CommandFile& operator=(const CommandFile&) = delete;

  void write(const RecordedStep& step, const JointVector& effort, std::uint64_t inputs_hash);
  /// @param about  of what this is: metadata record `baton.whatif`.
  void close(const mcap::StringMap& about);

 private:
  std::string controller_;
  std::int64_t step_ns_;
  mcap::Writer writer_;
  mcap::ChannelId channel_;
  std::uint32_t sequence_ = 0;
  std::uint64_t log_time_ns_ = 0;  // of the last message
  msg::JointCommand message_;
  std::vector<std::byte> buffer_;
};

}  // namespace baton
