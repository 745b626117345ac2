/// The elementary functions of the mathematics. Their results depend on their arguments alone: not on the processor,
/// the C library, the compiler or its options.
///
/// Why? glibc has several versions of sin, cos, atan2 and others and chooses one by the processor at run time; they
/// differ in the last bit, and a run's hash with them. SLEEF's `cinz` functions are the same sequence of IEEE 754
/// operations everywhere, without fused multiply-add. Measured against glibc: sin and cos 39 and 44 ns instead of 31
/// and 34, atan2 78 instead of 30. Two releases of SLEEF (3.5.1, 3.6.1) agree in every bit on 25 million arguments.
///
/// What IEEE 754 rounds correctly (sqrt, floor, remainder, copysign, fabs) may come from <cmath>.
#pragma once

#include <string>

namespace baton::elementary {

/// The library that computes them here, as in "SLEEF 3.6.1".
[[nodiscard]] std::string library();

struct SinCos {
  double sine;
  double cosine;
};

/// Errors below 1 ulp. NaN for infinite or NaN arguments. None throws or allocates.
[[nodiscard]] double sin(double angle_rad) noexcept;
[[nodiscard]] double cos(double angle_rad) noexcept;
[[nodiscard]] SinCos sincos(double angle_rad) noexcept;
[[nodiscard]] double tanh(double x) noexcept;
/// On [-pi, pi], with the signs of zero as in IEEE 754.
[[nodiscard]] double atan2(double y, double x) noexcept;
/// sqrt(x^2 + y^2) without overflow or underflow on the way.
[[nodiscard]] double hypot(double x, double y) noexcept;

}  // namespace baton::elementary
