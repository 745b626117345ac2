#include "control/mass_spring_damper.hpp"

#include <algorithm>
#include <cmath>

namespace baton {
namespace {

using Matrix3d = Eigen::Matrix3d;

/// e^A by scaling and squaring of the Taylor series (Golub, Van Loan, Matrix Computations, sec. 9.3): free of the
/// special cases of the closed form (critical damping, no stiffness, no damping), where its terms cancel.
Matrix3d exponential(const Matrix3d& A) noexcept {
  constexpr int kTerms = 14;  // 0.5^15 / 15! is far below rounding
  int squarings = 0;
  std::frexp(2.0 * A.cwiseAbs().rowwise().sum().maxCoeff(), &squarings);
  squarings = std::max(squarings, 0);
  const Matrix3d scaled = std::ldexp(1.0, -squarings) * A;

  Matrix3d sum = Matrix3d::Identity();
  for (int i = kTerms; i > 0; --i) sum = Matrix3d::Identity() + scaled * sum / i;  // Horner
  for (int i = 0; i < squarings; ++i) sum = (sum * sum).eval();
  return sum;
}

}  // namespace

MassSpringDamper::State MassSpringDamper::advanced(const State& state, double f, double dt_s) noexcept {
  if (dt_s != dt_s_) {
    // (z, z', f)' = A (z, z', f), as f stays.
    Matrix3d A;
    A << 0.0, 1.0, 0.0,                //
        -k_ / m_, -d_ / m_, 1.0 / m_,  //
        0.0, 0.0, 0.0;
    transition_ = exponential(dt_s * A).topRows<2>();
    dt_s_ = dt_s;
  }
  const Eigen::Vector2d next = transition_ * Eigen::Vector3d(state.z, state.zd, f);
  return {next(0), next(1)};
}

}  // namespace baton
