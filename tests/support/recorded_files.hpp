/// Recordings as the recorder writes them, made without a run, for tests of what the command line says of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace baton::test {

/// What it is like, and what is wrong with it: nothing unless it says so.
struct RecordingPlan {
  std::uint64_t samples = 200;  // of each stream
  std::size_t chunk_bytes = 4096;
  std::size_t parts = 1;  // files
  std::uint64_t first_sequence = 1;
  std::uint64_t leave_out = 0;  // of the first stream the sample of this number, from 1 on
  std::uint64_t change = 0;     // likewise: other bytes than were sent
  std::uint64_t repeat = 0;     // likewise: it is in the file twice
  bool is_seen = true;          // the recorder books what is in the file; otherwise it believes that all is well
  bool has_certificate = true;
  std::uint64_t dropped = 0;  // samples that the recorder had no room for
  std::string silent{};       // this service sends no manifest
  std::string stranger{};     // on this topic a process has written that calls itself by the next name
  std::string claim{};
  std::uint64_t stranger_lost = 0;  // of its samples, between the two that are there
};

/// Writes the recording of a run with a plant, a trajectory and a controller, each with one stream, into `name.mcap`,
/// or `name.mcap`, `name_0001.mcap`, ... Returns the names of the files.
std::vector<std::string> writeRecording(const std::filesystem::path& folder, const std::string& name,
                                        const RecordingPlan& plan = {});

}  // namespace baton::test
