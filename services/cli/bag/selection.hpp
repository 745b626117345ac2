/// What `bag cat`, `bag export` and `bag cut` take out of a recording: some topics, some of its time.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/recording_range.hpp"

namespace baton {

struct Selection {
  RecordingWish recording;
  std::vector<std::string> topics;  // all when empty
  RangeWish range;
};

/// The files, --parts and --topics.
void addTopicSelection(CLI::App& command, Selection& selection, const char* name = "files",
                       const char* text = kRecordingText);

/// The selection's topics between the range's times. Throws UsageError for a topic that the recording does not have.
[[nodiscard]] mcap::MessageFilter filterOf(const Selection& selection, const RecordingRange& range,
                                           const mcap::Source& reader);

/// The messages that were chosen. What cannot be read is left out and told on standard error.
class SelectedMessages {
 public:
  /// Throws what opening a recording, RecordingRange and filterOf() throw.
  explicit SelectedMessages(const Selection& selection);

  /// In order of log time. `use` returns false to end it early. Shows on the terminal how far it is, after `doing`,
  /// which is empty to show nothing. Throws UsageError when a range was asked for and there is nothing in it.
  void forEach(const std::string& doing, const std::function<bool(const mcap::MessageView&)>& use);

  /// Says something on standard error that makes the exit code kFailed.
  void complain(const std::string& problem) { complain(found_.files.string(), problem); }
  /// kOk when all that was chosen could be read and nobody complained.
  [[nodiscard]] ExitCode exitCode() const { return has_problem_ ? ExitCode::kFailed : ExitCode::kOk; }
  [[nodiscard]] const mcap::JoinedReader& reader() const { return reader_; }

 private:
  void complain(const std::string& file, const std::string& problem);
  [[nodiscard]] std::uint64_t expectedMessages() const;

  void warn(const std::string& file, const std::string& problem);

  bool has_problem_ = false;
  FoundRecording found_;
  ProgressLine progress_;
  mcap::JoinedReader reader_;  // finds damage while it is made, and tells of it
  RecordingRange range_;
  mcap::MessageFilter filter_;
  bool has_range_;
};

}  // namespace baton
