/// The counterfactual of a recorded run: what a law commands when it is given, step by step, what the holder of the
/// baton was given, beside what that one commanded. The arm goes where the recording says: it does not feel the law.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "control/parameters.hpp"
#include "effort_difference.hpp"
#include "mcap/joined_reader.hpp"
#include "recorded_steps.hpp"
#include "runtime/scenario.hpp"

namespace baton {

struct CounterfactualWish {
  std::string law;                    // empty: that of `as`
  std::string as;                     // the controller in whose place it is; empty: it holds the baton all the time
  std::vector<std::string> settings;  // "name=value"
  bool in_shadow = false;             // stands by at every step
};

/// Steps of which something could not be had.
struct Gap {
  std::uint64_t steps = 0;
  std::uint64_t first_step = 0;
  std::uint64_t last_step = 0;
  std::string reason;  // of the first

  void add(std::uint64_t step, std::uint64_t count = 1, const std::string& why = "");
  /// Nobody need have spoken for the last step of a recording: it is open.
  void spare(std::uint64_t step);
};

/// Steps in a row with one holder.
struct Tenure {
  std::string holder;  // empty: the plant's brake
  std::uint64_t first_step = 0;
  std::uint64_t last_step = 0;
  EffortDifference difference;
};

struct Counterfactual {
  CounterfactualWish wish;
  Scenario scenario;
  std::string law;
  ParameterValues parameters;        // it begins with
  std::size_t changes = 0;           // of parameters on the way, as recorded
  bool is_itself = false;            // the law and the parameters of the controller in whose place it is
  bool has_faulty_commands = false;  // by the scenario's wish, of that controller
  bool is_complete = false;          // by the recording's own certificate
  std::string cut;                   // where and why the file was cut off; empty: it was not
  std::uint64_t run_hash = 0;        // of the recorded run, as its last state tells it
  std::string run;                   // its id

  std::uint64_t first_step = 0;
  std::uint64_t steps = 0;   // with a state
  Gap without_inputs;        // not recorded: the law was not asked
  Gap without_effort;        // the law had none to give
  Gap without_recorded;      // nothing to hold it against
  Gap with_other_inputs;     // the holder computed from other bytes than the recorded ones
  EffortDifference overall;  // of the steps in which `as` held the baton, without `as` of all
  std::vector<Tenure> tenures;

  /// Only then are `overall` the steps of one controller.
  [[nodiscard]] bool isOfOneController() const { return !wish.as.empty() && !wish.in_shadow; }
};

/// Every effort of the law, as it comes, and the hash of what it was computed from (as in JointCommand).
using EffortSink = std::function<void(const RecordedStep&, const JointVector& effort, std::uint64_t inputs_hash)>;

/// Throws UsageError for a file that is not the recording of a run, a law that is not known or does not take its
/// parameters, and a law that uses force where no contact is recorded; and what reading a recording throws.
[[nodiscard]] Counterfactual counterfactual(const mcap::FileList& file, const CounterfactualWish& wish,
                                            const EffortSink& sink = {},
                                            const std::function<void(double)>& progress = {});

/// The law and its place, in words: "in the place of impedance", ...
[[nodiscard]] std::string placeOf(const CounterfactualWish& wish);

[[nodiscard]] nlohmann::ordered_json toJson(const Counterfactual& made);
/// A table to be read.
[[nodiscard]] std::string toText(const Counterfactual& made);

}  // namespace baton
