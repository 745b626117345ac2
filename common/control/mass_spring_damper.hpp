/// m z'' + d z' + k z = f in one coordinate, advanced exactly while f is held.
#pragma once

#include <Eigen/Core>

namespace baton {

class MassSpringDamper {
 public:
  struct State {
    double z = 0.0;   // m
    double zd = 0.0;  // m/s
  };

  /// @param m mass [kg], positive.  @param d damping [N s/m], not negative.  @param k stiffness [N/m], not negative.
  MassSpringDamper(double m, double d, double k) noexcept : m_(m), d_(d), k_(k) {}

  /// z'' under f [m/s^2].
  [[nodiscard]] double acceleration(const State& state, double f) const noexcept {
    return (f - d_ * state.zd - k_ * state.z) / m_;
  }

  /// The state dt_s later, with f held: no step is too long. The transition is computed when dt_s changes, which in a
  /// run it does once.
  [[nodiscard]] State advanced(const State& state, double f, double dt_s) noexcept;

  [[nodiscard]] double mass() const noexcept { return m_; }
  [[nodiscard]] double damping() const noexcept { return d_; }
  [[nodiscard]] double stiffness() const noexcept { return k_; }

 private:
  double m_, d_, k_;
  double dt_s_ = 0.0;
  Eigen::Matrix<double, 2, 3> transition_ = Eigen::Matrix<double, 2, 3>::Identity();  // (z, z', f) to (z, z')
};

}  // namespace baton
