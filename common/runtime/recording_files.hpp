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
  std::vector<std::string> missing;  // a sentence for each hole between the files: parts that are not among them
};

/// The files alone, folders and other parts resolved, for whoever looks into them itself. Throws as below.
[[nodiscard]] std::vector<std::string> filesOf(const RecordingWish& wish);

/// A single file is taken as it is, whatever it says. Throws UsageError when files are not of one recording (of several
/// runs, recorded by others, one twice, two that have the same time of a run) or a folder has none, UnavailableError
/// when one cannot be opened, and what reading a recording throws.
[[nodiscard]] FoundRecording findRecording(const RecordingWish& wish);

/// The same; prints holes on standard error, and then sets `exit_code` to kFailed.
[[nodiscard]] mcap::FileList findRecording(const RecordingWish& wish, ExitCode& exit_code);

}  // namespace baton
