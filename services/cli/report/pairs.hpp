/// The handovers of a run that goes round all ordered pairs of its controllers, as a table: law by law, what the joints
/// felt at the first step K of each new holder.
///
/// A handover is without a bump when, joint by joint,
///   |tau(K) - tau(K-1)| <= max(|tau_o(K) - tau_o(K-1)|, |tau_i(K+1) - tau_i(K)|) + 1e-9,
/// tau what the joint felt, tau_o and tau_i what the outgoing and the incoming law commanded: it is not seen among the
/// changes that either law makes by itself from one step to the next.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "efforts.hpp"
#include "theory.hpp"

namespace baton {

inline constexpr double kBumpTolerance = 1e-9;  // N m or N

/// One entry a joint [N m or N]; NaN where something was not recorded.
struct PairHandover {
  std::size_t from = 0;  // index of a controller
  std::size_t to = 0;
  std::uint64_t at_step = 0;      // K
  Eigen::VectorXd change;         // |tau(K) - tau(K-1)|
  Eigen::VectorXd own;            // the larger of the two laws' own changes around K
  Eigen::VectorXd without_blend;  // |tau_i(K) - tau(K-1)|: what the joints would have felt without the blend
  double tip_speed = 0.0;         // at K [m/s]
  bool touches = false;           // at K
  bool has_report = false;
  bool cut_short = false;
  std::uint64_t rate_limit_hits = 0;  // over the blend
  double rate_share = 0.0;            // largest rate of a torque over the blend, as a part of its limit
  double blend_energy = 0.0;          // [J]
  double force_deviation = 0.0;       // [N]

  /// Of the joint where it is largest: change over own + tolerance; at most 1 without a bump.
  [[nodiscard]] double ratio() const;
  /// By how much a change exceeds what the laws do themselves; 0 when none does [N m or N].
  [[nodiscard]] double excess() const;
};

struct PairRefusal {
  std::size_t from = 0;
  std::size_t to = 0;
  std::uint64_t decided_at_step = 0;
  std::string reason;
};

struct PairTable {
  const RecordedEfforts* run = nullptr;
  std::vector<PairHandover> handovers;  // in order; failovers are not among them
  std::vector<PairRefusal> refusals;
};

/// The table refers to `run`.
[[nodiscard]] PairTable pairsOf(const RecordedEfforts& run);

/// That every ordered pair was handed over, or refused where the incoming law needs a contact that is not there; that
/// none made a bump or hit the limit of the torques' rates; that no step was lost or doubled; that the arm stood or
/// moved, in contact or free, at all of them alike.
[[nodiscard]] std::vector<Check> checksOf(const PairTable& table);

/// For the page: law by law, with the reasons of what was refused below.
[[nodiscard]] std::string toHtml(const PairTable& table);

}  // namespace baton
