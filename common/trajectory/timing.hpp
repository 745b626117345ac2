/// How a motion goes from rest to rest along a segment, whatever it moves: joints or the tip.
#pragma once

namespace baton {

/// Siciliano et al. (2009), sec. 4.2.1: the cubic is the least that rests at both ends, the quintic starts and ends
/// without acceleration as well, the trapezoidal velocity profile keeps the peak speed lowest for a given acceleration.
enum class Interpolation { kCubic, kQuintic, kTrapezoidal };

struct Timing {
  Interpolation interpolation = Interpolation::kQuintic;
  double ramp = 0.25;  // trapezoidal: part of a segment spent speeding up, and as much slowing down; above 0, up to 0.5
};

/// How far along, from 0 to 1, and its derivatives with respect to whatever the argument was.
struct Progress {
  double s = 0.0;
  double ds = 0.0;
  double dds = 0.0;
};

/// Progress at u, the part of the segment's time that has passed, in [0, 1]; derivatives with respect to u. Where the
/// acceleration jumps, the value is the one that follows.
[[nodiscard]] Progress progressAt(const Timing& timing, double u) noexcept;

}  // namespace baton
