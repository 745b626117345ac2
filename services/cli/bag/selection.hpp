/// What `bag cat`, `bag export` and `bag cut` take out of a recording: some topics, some of its time.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "mcap/reader.hpp"
#include "runtime/progress_line.hpp"

namespace baton {

struct Selection {
  std::string file;
  std::vector<std::string> topics;  // all when empty
  std::optional<double> from_s;     // of log time, from the recording's first message
  std::optional<double> to_s;
};

/// The file and --topics.
void addTopicSelection(CLI::App& command, Selection& selection);
/// --from and --to.
void addTimeSelection(CLI::App& command, Selection& selection);

/// Throws UsageError for a topic that the recording does not have, times in the wrong order, and those outside of it.
[[nodiscard]] mcap::MessageFilter filterOf(const Selection& selection, const mcap::Reader& reader);

/// The messages that were chosen. What cannot be read is left out and told on standard error.
class SelectedMessages {
 public:
  /// Throws what opening a recording and filterOf() throw.
  explicit SelectedMessages(const Selection& selection);

  /// In order of log time. `use` returns false to end it early. Shows on the terminal how far it is, after `doing`,
  /// which is empty to show nothing.
  void forEach(const std::string& doing, const std::function<bool(const mcap::MessageView&)>& use);

  /// Says something on standard error that makes the exit code kFailed.
  void complain(const std::string& problem);
  /// kOk when all that was chosen could be read and nobody complained.
  [[nodiscard]] ExitCode exitCode() const { return has_problem_ ? ExitCode::kFailed : ExitCode::kOk; }
  [[nodiscard]] const mcap::Reader& reader() const { return reader_; }

 private:
  [[nodiscard]] std::uint64_t expectedMessages() const;

  void warn(const std::string& problem);

  std::set<mcap::Damage> damage_;  // each pass comes across the same
  bool has_problem_ = false;
  std::string file_;
  ProgressLine progress_;
  mcap::Reader reader_;  // finds damage while it is made, and tells of it
  mcap::MessageFilter filter_;
};

}  // namespace baton
