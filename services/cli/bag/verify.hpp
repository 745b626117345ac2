/// `baton bag verify`: whether a recording is complete, proven again from its bytes alone.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bag/log_times.hpp"
#include "bag/verdict.hpp"
#include "runtime/ledger.hpp"

namespace baton {

struct Verification {
  std::vector<std::string> files;  // the parts, in their order
  // One sentence for each thing that was found.
  std::vector<std::string> damage;   // bytes that cannot be read, or are not those that were written
  std::vector<std::string> cuts;     // where a file ends in the middle
  std::vector<std::string> missing;  // messages that are missing, and what keeps completeness from being proven
  std::vector<std::string> remarks;  // on topics that are none of Baton's, which are not what the verdict is on
  std::string summary;               // the certificate's verdict, in its words
  bool is_traffic = false;           // recorded without a run: no manifest counts
  Ledger ledger{{}};                 // every stream as the bytes give it, beside what its writer says of it
  LogTimes log_times;                // whose jumps take nothing from the verdict
  std::uint64_t messages = 0;        // that could be read
  std::uint64_t bytes = 0;           // of the files

  [[nodiscard]] RecordingVerdict verdict() const;
};

/// Reads everything, every checksum with it, and books each message as the recorder did: the accounts are held against
/// the manifests that the services sent at the end, and the certificate in the file against the accounts. Several files
/// are the parts of one recording. Memory is that of a chunk, and of an
/// attachment at a time.
/// @param progress  told which part of the work is done, from 0 to 1.
/// @param unreadable  a sentence for each part that cannot be opened: damage.
/// Throws UsageError when a file is not a recording, or the files are not parts of one, and UnavailableError when one
/// cannot be opened.
[[nodiscard]] Verification verifyRecording(const std::vector<std::string>& files,
                                           const std::function<void(double)>& progress,
                                           const std::vector<std::string>& unreadable = {});

}  // namespace baton
