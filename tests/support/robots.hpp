/// The robots that tests use, as data.
#pragma once

#include "robot/model.hpp"

namespace baton::test {

/// The report's RPP arm: a joint that turns about a horizontal axis, one that slides along it, one that slides along
/// the arm. Density 2700 kg/m^3. Link 1's inertia about the joint is what makes B11(q3 = 0.1 m) = 0.3425 kg m^2, the
/// report's figure; the other links are plain bars.
[[nodiscard]] RobotModel rppRobot();

/// The report's one-joint link, I qdd + F qd + m g d sin(q) = tau, hanging down at q = 0. Its inertia about the joint
/// is smaller than m d^2, so it is a valid equation but no possible body.
[[nodiscard]] RobotModel link1Robot();

/// A mass that slides along z, weightless: the tip is its position.
[[nodiscard]] RobotModel slider(double mass_kg);

/// A chain of n joints of mixed kinds with random geometry and random physically possible links; no friction. The same
/// seed gives the same chain.
[[nodiscard]] RobotModel randomChain(int n, unsigned seed);

/// The same with revolute joints only.
[[nodiscard]] RobotModel randomRevoluteChain(int n, unsigned seed);

/// A random number in [low, high] of a seeded generator; the same on every machine.
template <typename Generator>
[[nodiscard]] double uniform(Generator& generator, double low, double high) {
  const double unit =
      static_cast<double>(generator() - Generator::min()) / static_cast<double>(Generator::max() - Generator::min());
  return low + (high - low) * unit;
}

/// A vector of n random numbers in [-size, size].
template <typename Generator>
[[nodiscard]] JointVector randomJointVector(Generator& generator, int n, double size) {
  JointVector v(n);
  for (int i = 0; i < n; ++i) v(i) = uniform(generator, -size, size);
  return v;
}

}  // namespace baton::test
