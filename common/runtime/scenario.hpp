/// A whole experiment as a plain struct: what a scenario file says, checked. scenario_file.cpp reads it, README.md
/// documents the file. Every service of a run reads the same file.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "control/arm.hpp"
#include "control/parameter_schedule.hpp"
#include "control/parameters.hpp"
#include "environment/plane.hpp"
#include "robot/model.hpp"
#include "time/fault.hpp"
#include "trajectory/trajectory.hpp"

namespace baton {

enum class SimMode { kLockstep, kRealtime };

/// What the plant does about a step that does not end.
enum class LatePolicy { kWait, kFallback, kAbort };

struct ControllerConfig {
  std::string name;  // unique in the scenario
  std::string law;
  ParameterValues parameters;  // complete and checked
};

enum class SwapExpectation { kDone, kRefused, kAny };

struct PlannedSwap {
  std::uint64_t at_step = 0;
  std::string to;
  bool force = false;                               // even if the forecast is above max_effort_step
  bool hard = false;                                // no help: no blend, and the incoming law starts anew
  std::optional<std::uint64_t> blend_steps;         // as BatonConfig says when not given; none when hard
  SwapExpectation expect = SwapExpectation::kDone;  // a run in which it goes otherwise has failed
};

/// The plant takes a controller for failed, whatever its process does.
struct PlannedFailure {
  std::optional<std::uint64_t> at_step;  // that is open then; not given: it has failed before the first step
  std::string controller;
  bool commanded = true;                         // its command for that step counts still
  std::optional<std::uint64_t> returns_at_step;  // stands by again; not given: never
  bool restarted = false;                        // returns as a new process would, which remembers nothing
};

/// A request to end the run, made while it ran: from then on no handover for the end or later is made.
struct PlannedStop {
  std::uint64_t decided_at_step = 0;
  std::uint64_t at_step = 0;
};

struct PlannedChange {
  std::string controller;
  ParameterChange change;  // values checked, and as many as the parameter has
};

inline constexpr double kMaxBlend_s = 10.0;

struct BatonConfig {
  std::uint64_t margin_steps = 5;     // steps between the decision and the swap; 3 in realtime when left out
  std::uint64_t blend_steps = 200;    // over which the difference between the two torques fades
  double max_effort_step = 50.0;      // forecast above this is refused, any joint [N m or N]
  double max_command = 1e6;           // a holder that commands more has failed [N m or N]
  JointVector max_effort_rate;        // n entries: faster changes in a handover are counted [N m/s or N/s]
  std::vector<std::string> fallback;  // who takes over from a holder that fails, in order; then the brake
};

struct RecordingConfig {
  bool enabled = true;
  std::string compression = "zstd";                  // none, lz4, zstd
  int level = 0;                                     // of the compression; 0: the library's own default
  std::size_t chunk_bytes = std::size_t{256} << 10;  // of larger ones the file gains 1 %, the process 2 MB
  bool starts_stopped = false;                       // waits for `record start`
  std::vector<std::string> topics;                   // patterns; empty: all topics
  std::vector<std::string> except;                   // patterns of those that are left out
  bool takes_foreign = true;                         // also topics that are none of Baton's
  std::uint64_t split_bytes = 0;                     // a part that has grown to this is followed by another; 0: never
  std::uint64_t split_steps = 0;                     // likewise, by steps of the run
  [[nodiscard]] bool isSplit() const { return split_bytes > 0 || split_steps > 0; }
  std::uint64_t ring_steps = 0;  // kept in memory alone, until they are asked for or the run ends; 0: no ring
  std::uint64_t ring_bytes = 256'000'000;
  std::uint64_t max_bytes = 0;  // of all parts together; 0: no limit
  bool drops_oldest = false;    // when they are reached, the oldest part goes; else the recording ends
  std::uint64_t min_free_bytes =
      10'000'000;                    // likewise, before less is left on the disk, for logs and the run's result
  std::uint64_t credit_steps = 256;  // lockstep: how far the plant may run past the recorder
  std::uint64_t checkpoint_steps =
      0;                     // every so many steps all parts save their state, for branches; 0: at the end alone
  bool sync_chunks = false;  // every chunk waits for the storage device
  double sync_s = 0.0;       // all that is in the file does, so often; 0: at the end alone
};

struct Scenario {
  std::string file;        // absolute path it was read from
  std::string text;        // the file, as it was
  std::string robot_file;  // absolute path
  std::string robot_text;
  std::string name;
  std::string description;
  RobotModel robot;  // with the effort limits of the scenario, where it gives some
  std::int64_t step_ns = 1'000'000;
  int substeps = 1;
  std::uint64_t end_step = 0;  // 0: until stopped
  SimMode mode = SimMode::kLockstep;
  double rate = 0.0;  // simulated seconds per second, 0 for as fast as possible; 1 in realtime
  /// Realtime: steps an old torque may be kept; a holder that misses one more is given up. When left out: 20, or fewer,
  /// so that a holder that falls silent is given up within 20 ms.
  std::uint64_t max_missed_steps = 20;
  LatePolicy late_policy = LatePolicy::kAbort;
  double late_after_s = 30.0;  // wall time
  JointVector start_q;
  JointVector start_qd;
  std::vector<PlaneSpec> walls;  // none: no environment process
  Coupling coupling = Coupling::kDerivatives;
  TrajectorySpec trajectory;
  std::vector<ControllerConfig> controllers;
  std::string active;                    // who holds the baton at step 0
  bool hot_standby = true;               // controllers standing by compute in shadow
  std::vector<PlannedSwap> swaps;        // by step
  std::vector<PlannedFailure> failures;  // by step; those of one controller follow each other
  std::vector<PlannedStop> stops;        // by the step they are decided at
  std::vector<PlannedChange> changes;    // by step
  BatonConfig baton;
  RecordingConfig recording;
  std::vector<Fault> faults;          // that strike on purpose
  std::vector<std::string> warnings;  // what is odd but workable, with file and line
  std::string fast_pole;              // what is too fast for the sub-steps, and which would do; empty: nothing

  [[nodiscard]] double stepSeconds() const { return static_cast<double>(step_ns) * 1e-9; }
  /// Whether all parts save their state at the start of this step: now and then, and at the end; not where a message
  /// is stuck, since what it is stuck at is in nobody's state.
  [[nodiscard]] bool hasCheckpointAt(std::uint64_t step) const;
  [[nodiscard]] bool hasEnvironment() const { return !walls.empty(); }
  /// Whether something of this service goes wrong on purpose.
  [[nodiscard]] bool wantsFaultOf(const std::string& service) const;
  [[nodiscard]] bool plansFailureOf(const std::string& controller_name) const;
  /// Why the motion may have run away, and what to do.
  /// @param contact  of that step.  @param is_its_doing  without that contact it would have gone on.
  [[nodiscard]] std::string lostMotion(const Contact& contact, bool is_its_doing) const;
  /// The arm at the start of the run.
  [[nodiscard]] ArmConfig armConfig() const;
  /// The controller called that; throws UsageError, with the nearest name, when there is none.
  [[nodiscard]] const ControllerConfig& controller(const std::string& controller_name) const;
  /// What is planned for its parameters.
  [[nodiscard]] std::vector<ParameterChange> changesOf(const std::string& controller_name) const;
};

/// Reads and checks a scenario file and the robot file it names. Throws UsageError with file, line, what was expected
/// and what was found.
[[nodiscard]] Scenario loadScenario(const std::string& path, const std::string& robot_path = "");

/// The same from text already in memory (a recording's attachments); `file` is used in messages, `robot_text` stands in
/// for the robot file.
[[nodiscard]] Scenario parseScenario(const std::string& file, const std::string& text, const std::string& robot_file,
                                     const std::string& robot_text);

/// Reads and checks a robot file; warnings are appended to `warnings` when it is given.
[[nodiscard]] RobotModel loadRobot(const std::string& path, std::vector<std::string>* warnings = nullptr);
[[nodiscard]] RobotModel parseRobot(const std::string& file, const std::string& text,
                                    std::vector<std::string>* warnings = nullptr);

}  // namespace baton
