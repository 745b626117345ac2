/// How well a run went, in numbers: errors of each joint and task axis, efforts, contact force.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "trace.hpp"

namespace baton {

/// Of one error signal e = desired - actual over the run. A set-point y1, reached from the actual value y0 at the
/// start, makes a stroke |y1 - y0|; where the desired value moves, there is no stroke, or the recording begins after
/// step 0, overshoot and settling are NaN. Where steps were not recorded the integrals are NaN, and peaks are of what
/// was recorded.
struct ErrorMetrics {
  std::string name;         // "q1", "x"
  std::string unit;         // of the error
  double final = 0.0;       // e at the last step
  double rms = 0.0;         // sqrt(1/T int e^2 dt)
  double peak = 0.0;        // max |e|
  double iae = 0.0;         // int |e| dt, unit times s
  double overshoot = 0.0;   // how far the actual value goes beyond y1, seen from y0, as a part of the stroke
  double settling_s = 0.0;  // from when on |y - y1| stays within 2 % of the stroke; NaN when it never does
};

struct EffortMetrics {
  std::string name;
  std::string unit;
  double peak = 0.0;         // max |tau| as applied
  double saturated_s = 0.0;  // time spent at the joint's limit
};

struct Metrics {
  std::uint64_t steps = 0;
  std::uint64_t unrecorded_steps = 0;  // in between, without their state or their reference
  double duration_s = 0.0;
  std::vector<ErrorMetrics> joints;  // empty when no joint reference was given
  std::vector<ErrorMetrics> task;    // x, y, z, and the angle between the orientations; empty without a task reference
  std::vector<EffortMetrics> efforts;
  // Of the tip on the environment; NaN when no contact was recorded.
  Vector3 final_force_N = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector3 peak_force_N = final_force_N;  // per axis, with its sign
  std::uint64_t missed_steps = 0;
};

[[nodiscard]] Metrics metricsOf(const Trace& trace);

[[nodiscard]] nlohmann::ordered_json toJson(const Metrics& metrics);
/// A table to be read.
[[nodiscard]] std::string toText(const Metrics& metrics);

}  // namespace baton
