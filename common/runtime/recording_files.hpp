/// What a command line names as one recording: a file, several files, a folder of them.
///
/// Several files come in the order of what they say of themselves: the parts of a recording that was split by their
/// number, others by the time of their first message. Their names mean nothing.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "mcap/joined_reader.hpp"

namespace baton {

struct RecordingWish {
  std::vector<std::string> given{};
  bool with_parts = false;  // also the other parts of those that are parts, from their folders
};

inline constexpr const char* kRecordingText = "recording (MCAP); several, or a folder of them: read as one";
/// Of a command that compares two, which takes one name for each.
inline constexpr const char* kOneRecordingText = "recording (MCAP), or a folder of files: read as one";
/// The positional argument `name` and --parts.
CLI::Option* addRecording(CLI::App& command, RecordingWish& wish, const char* name = "files",
                          const char* text = kRecordingText);
void addParts(CLI::App& command, bool& with_parts);

struct FoundRecording {
  mcap::FileList files;
  /// A sentence for each hole: parts that are not among the files, or cannot be read. Before the first and after the
  /// last one where all were asked for, by --parts or a folder.
  std::vector<std::string> missing;
};

/// The files alone, folders and other parts resolved, for whoever looks into them itself. Throws as below.
/// @param unreadable  gets a sentence for each part that lies next to them and cannot be read.
[[nodiscard]] std::vector<std::string> filesOf(const RecordingWish& wish,
                                               std::vector<std::string>* unreadable = nullptr);

/// What is missing of the split recordings, of any runs, of which the files are parts, in a sentence each. Throws what
/// opening a recording throws.
[[nodiscard]] std::vector<std::string> missingParts(const std::vector<std::string>& files);

/// A single file is taken as it is, whatever it says. Throws UsageError when files are not of one recording (of several
/// runs, recorded by others, one twice, two that have the same time of a run) or a folder has none, UnavailableError
/// when one cannot be opened, and what reading a recording throws.
[[nodiscard]] FoundRecording findRecording(const RecordingWish& wish);

/// The same; prints holes on standard error, and then sets `exit_code` to kFailed.
[[nodiscard]] mcap::FileList findRecording(const RecordingWish& wish, ExitCode& exit_code);

/// Says on standard error why a recording is not complete, when it is not, and then sets `exit_code` to kFailed.
void warnIfIncomplete(const std::string& file, const mcap::FileInfo& info, ExitCode& exit_code);

}  // namespace baton
