/// Checkpoints: what a part of a run needs to go on from a step. PlantState says at which steps they are made; they go
/// out on a topic of their own and into the recording; a branch starts from those of one step. A part lists its state
/// in one function, archive(StateArchive&), for both ways.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/state_archive.hpp"
#include "mcap/joined_reader.hpp"
#include "runtime/service.hpp"

namespace baton {

/// The checkpoints of one step, by the name of the service.
struct CheckpointSet {
  std::uint64_t step = 0;
  std::map<std::string, std::vector<std::uint8_t>> states;
};

/// The newest step up to `at_step` of which the recording has the checkpoints of all `services`, from a log time on (a
/// run that was reset begins anew in the middle of its file); step 0 without states when there is none: a run's
/// beginning needs no checkpoint. Throws what reading a recording throws.
[[nodiscard]] CheckpointSet newestCheckpoint(const mcap::FileList& recording, std::uint64_t begin_ns,
                                             std::uint64_t at_step, const std::vector<std::string>& services);

/// One set as a file of its own (MCAP), which the services of a branch read. Throws UnavailableError.
void writeCheckpoint(const std::filesystem::path& file, const CheckpointSet& set, std::int64_t step_ns);
/// Throws UsageError when the file is not one.
[[nodiscard]] CheckpointSet readCheckpoint(const std::filesystem::path& file);

/// A service's side.
class Checkpoints {
 public:
  explicit Checkpoints(Service& service);

  /// Publishes the state of `part` at the start of `step`. From handlers; allocates nothing.
  template <class Part>
  void save(std::uint64_t step, Part& part) {
    message_.state().resize(msg::MAX_CHECKPOINT);
    StateArchive archive = StateArchive::into(std::as_writable_bytes(std::span(message_.state())));
    part.archive(archive);
    publish(step, archive);
  }

  /// When the run is a branch: gives `part` its state back and returns true. Throws UsageError when the checkpoint is
  /// of something else. A service that the checkpoint does not know starts afresh.
  template <class Part>
  bool restore(Part& part) {
    const auto found = from_.states.find(service_.options().name);
    if (found == from_.states.end()) return false;
    StateArchive archive = StateArchive::from(std::as_bytes(std::span(found->second)));
    part.archive(archive);
    if (!archive.isWhole()) refuse();
    return true;
  }

  /// The step at which the run begins.
  [[nodiscard]] std::uint64_t firstStep() const { return from_.step; }

 private:
  void publish(std::uint64_t step, const StateArchive& archive);
  [[noreturn]] void refuse() const;

  Service& service_;
  CheckpointSet from_;
  dds::Writer<msg::Checkpoint>& out_;
  msg::Checkpoint message_;
};

}  // namespace baton
