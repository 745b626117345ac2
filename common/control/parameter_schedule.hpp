/// Which parameters a law has at which step: those it starts with, and from some steps on others. A law is made with
/// its parameters, so for a change another law of the same kind is made beforehand; at its step that one takes over
/// what the one before remembers. Changes that a scenario plans are there from the start; those an operator asks for
/// are drafted, made and accepted. Knows no lock: whoever has one holds it for everything but make().
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "control/law.hpp"
#include "control/parameters.hpp"
#include "robot/model.hpp"

namespace baton {

struct ParameterChange {
  std::uint64_t at_step = 0;  // the first step that is computed with it
  ParameterValues set;        // what changes; the other parameters stay
  bool is_planned = false;    // by the scenario
};

class ParameterSchedule {
  struct Entry {
    ParameterChange change;
    ParameterValues values;  // complete
    std::unique_ptr<Law> law;
  };

 public:
  /// Of those an operator asked for; a checkpoint has room for them.
  static constexpr std::size_t kMaxWaiting = 8;

  /// Keeps references to `law` and `model`. Throws UsageError when a value is not as declared, or the law refuses.
  /// @param start  the parameters at the start, complete.  @param planned  changes, in any order.
  ParameterSchedule(const LawInfo& law, const RobotModel& model, ParameterValues start,
                    std::vector<ParameterChange> planned);

  [[nodiscard]] Law& law() noexcept { return *entries_[in_force_].law; }
  /// In force, complete.
  [[nodiscard]] const ParameterValues& values() const noexcept { return entries_[in_force_].values; }

  /// `step` is about to be computed: what has waited for it comes into force. True when something did. Never allocates.
  bool advance(std::uint64_t step) noexcept;

  /// A change as the schedule stands, and all that wait behind it, which it alters too.
  struct Draft {
    std::uint64_t revision = 0;
    std::size_t place = 0;   // among the entries
    ParameterValues before;  // in force until then
    std::vector<ParameterChange> changes;
    std::vector<Entry> entries;  // made of `changes`; after accept() what these have replaced
  };
  /// @param next_step  the first step that is not computed yet; an earlier one cannot be changed.
  /// Throws UsageError when nothing is to change or too many wait already.
  [[nodiscard]] Draft draft(const ParameterChange& change, std::uint64_t next_step) const;
  /// Makes the laws. Touches nothing that changes: may run beside any other function. Throws as the constructor does.
  void make(Draft& draft) const;
  /// Takes the change in and returns it as it will happen: all values whole, and at `next_step` if that is later than
  /// what was drafted. Nothing when a change has come into force meanwhile, or would now come in another order: draft
  /// it again.
  [[nodiscard]] std::optional<ParameterChange> accept(Draft& draft, std::uint64_t next_step);

  /// Back to the start of the run: with what was planned, without what was asked for.
  void rewind();

  /// What is in force and what was asked for and waits; not the state of the law. A parameter for which the scenario
  /// now has another value than when it was saved takes that.
  /// @param first_step  restoring: where the run goes on; what was planned for earlier is in force.
  void archive(StateArchive& state, std::uint64_t first_step);

 private:
  [[nodiscard]] std::vector<Entry> made(const ParameterValues& before, std::vector<ParameterChange> changes) const;
  void begin(const ParameterValues& values, std::vector<ParameterChange> waiting);
  void archiveValue(StateArchive& state, const ParameterSpec& spec, ParameterValue& value) const;
  [[nodiscard]] ParameterValues archiveInForce(StateArchive& state) const;
  [[nodiscard]] std::vector<ParameterChange> archiveAsked(StateArchive& state) const;
  [[nodiscard]] std::vector<ParameterChange> asked() const;

  const LawInfo& info_;
  const RobotModel& model_;
  ParameterValues start_;
  std::vector<ParameterChange> planned_;  // by step
  std::vector<Entry> entries_;            // the first one is, or was, in force; the others in the order of their steps
  std::size_t in_force_ = 0;
  std::uint64_t revision_ = 0;    // of what is in force and what waits
  std::vector<std::byte> state_;  // what one law hands to the next
};

}  // namespace baton
