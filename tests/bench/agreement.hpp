/// How far two libraries are apart, so that what is timed is known to be the same thing.
#pragma once

#include <algorithm>
#include <cmath>

#include "bench/baton_dynamics.hpp"

namespace baton::bench {

/// Each library rounds at about 1e-15 per operation; the conditioning of B takes some digits of forward dynamics.
inline constexpr double kAgreement = 1e-10;

/// |a - b| / (1 + |b|); NaN counts as infinitely far.
template <typename A, typename B>
[[nodiscard]] double distance(const A& a, const B& b) {
  const double relative = (a - b).norm() / (1.0 + b.norm());
  return std::isfinite(relative) ? relative : HUGE_VAL;
}

/// The largest distance of any quantity at any of the states, by library objects of the same arm and states.
template <typename A, typename B>
[[nodiscard]] double largestDistance(A& a, B& b, int states) {
  double largest = 0.0;
  for (int k = 0; k < states; ++k) {
    const Terms a_terms = a.terms(k), b_terms = b.terms(k);
    largest = std::max(
        {largest, distance(a_terms.B, b_terms.B), distance(a_terms.n, b_terms.n), distance(a_terms.g, b_terms.g)});
    largest = std::max({largest, distance(a.inverseDynamics(k), b.inverseDynamics(k)),
                        distance(a.massMatrix(k), b.massMatrix(k)),
                        distance(a.forwardDynamics(k), b.forwardDynamics(k)), distance(a.gravity(k), b.gravity(k))});
  }
  return largest;
}

}  // namespace baton::bench
