#include "support/robots.hpp"

#include <Eigen/Geometry>
#include <random>

namespace baton::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGravity = 9.806;   // m/s^2
constexpr double kDensity = 2700.0;  // kg/m^3

/// Inertia about the centre of mass of a box whose long side lies along z.
Matrix3 barInertia(double mass, double width, double length) {
  const double across = mass / 12.0 * (width * width + length * length);
  return Vector3(across, across, mass / 6.0 * width * width).asDiagonal();
}

Vector3 randomVector(std::mt19937& generator, double size) {
  const double x = uniform(generator, -size, size);
  const double y = uniform(generator, -size, size);
  return {x, y, uniform(generator, -size, size)};
}

/// A uniform ellipsoid, so a possible body, at a random place and angle.
LinkInertia randomLink(std::mt19937& generator) {
  const double mass = uniform(generator, 0.5, 5.0);
  const Vector3 centre = randomVector(generator, 0.2);
  const Vector3 axis = randomVector(generator, 1.0).normalized();
  const Matrix3 R = Eigen::AngleAxisd(uniform(generator, 0.0, kPi), axis).toRotationMatrix();
  const Vector3 squares = (Vector3::Constant(0.15) + randomVector(generator, 0.1)).cwiseAbs2();
  const Vector3 principal = mass / 5.0 * (Vector3::Constant(squares.sum()) - squares);
  return LinkInertia::fromCentreOfMass(mass, centre, R * principal.asDiagonal() * R.transpose());
}

DhRow randomRow(std::mt19937& generator) {
  const double a = uniform(generator, -0.5, 0.5);
  const double alpha = uniform(generator, -kPi, kPi);
  const double theta = uniform(generator, -kPi, kPi);
  return {a, alpha, theta, uniform(generator, -0.5, 0.5)};
}

RobotModel randomRobot(int n, unsigned seed, bool mixed) {
  std::mt19937 generator(seed);
  RobotModel robot;
  robot.name = "random";
  robot.base = randomRow(generator);
  for (int i = 0; i < n; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    if (mixed && uniform(generator, 0.0, 1.0) < 0.4) joint.kind = JointKind::kPrismatic;
    joint.dh = randomRow(generator);
    joint.link = randomLink(generator);
    robot.joints.push_back(joint);
  }
  return robot;
}

}  // namespace

RobotModel rppRobot() {
  RobotModel robot;
  robot.name = "rpp";
  robot.base = {.a_m = 0.0, .alpha_rad = kPi / 2, .theta_rad = 0.0, .d_m = 0.4};
  robot.gravity_W = {0.0, 0.0, -kGravity};

  Joint shoulder;
  shoulder.name = "shoulder";
  shoulder.dh = {.a_m = 0.4, .alpha_rad = 0.0, .theta_rad = 0.0, .d_m = 0.0};
  const double radius = 0.02, mass_1 = kDensity * 0.4 * kPi * radius * radius;

  Joint slide;
  slide.name = "slide";
  slide.kind = JointKind::kPrismatic;
  slide.dh = {.a_m = 0.0, .alpha_rad = kPi / 2, .theta_rad = kPi / 2, .d_m = 0.46};
  const double mass_2 = kDensity * 0.46 * 0.03 * 0.03;
  const Matrix3 inertia_2 = barInertia(mass_2, 0.03, 0.46);
  slide.link = LinkInertia::fromCentreOfMass(mass_2, {0.0, 0.0, -0.23}, inertia_2);

  Joint reach;
  reach.name = "reach";
  reach.kind = JointKind::kPrismatic;
  reach.dh = {.a_m = 0.0, .alpha_rad = 0.0, .theta_rad = -kPi / 2, .d_m = 0.15};
  const double mass_3 = kDensity * 0.15 * 0.01 * 0.01;
  const Matrix3 inertia_3 = barInertia(mass_3, 0.01, 0.15);
  reach.link = LinkInertia::fromCentreOfMass(mass_3, {0.0, 0.0, -0.075}, inertia_3);

  // B11(q3) = lumped + m3 (0.475 + q3)^2. Link 1 gets what the lumped figure leaves after the steady parts of
  // all three; only its component about the joint reaches the equations, the others are those of a rod along x.
  const double lumped = 0.3425 - mass_3 * (0.475 + 0.1) * (0.475 + 0.1);
  const double across_1 = lumped - mass_1 * 0.2 * 0.2 - mass_2 * 0.17 * 0.17 - inertia_2(0, 0) - inertia_3(0, 0);
  const Matrix3 inertia_1 = Vector3(0.5 * mass_1 * radius * radius, across_1, across_1).asDiagonal();
  shoulder.link = LinkInertia::fromCentreOfMass(mass_1, {-0.2, 0.0, 0.0}, inertia_1);

  robot.joints = {shoulder, slide, reach};
  return robot;
}

RobotModel link1Robot() {
  RobotModel robot;
  robot.name = "link1";
  robot.base = {.a_m = 0.0, .alpha_rad = kPi / 2, .theta_rad = 0.0, .d_m = 0.0};
  robot.gravity_W = {0.0, 0.0, -kGravity};

  // The link's frame sits on the joint, with x along the link.
  Joint pivot;
  pivot.name = "pivot";
  pivot.dh = {.a_m = 0.0, .alpha_rad = 0.0, .theta_rad = -kPi / 2, .d_m = 0.0};
  const double mass = 1.1 * 1.1 * 3.5 * 2.7, distance = 1.75;
  pivot.link = {mass, {mass * distance, 0.0, 0.0}, 0.1 * Matrix3::Identity()};
  pivot.friction.viscous = 0.2;
  robot.joints = {pivot};
  return robot;
}

RobotModel slider(double mass_kg) {
  Joint joint;
  joint.name = "slide";
  joint.kind = JointKind::kPrismatic;
  joint.link.mass_kg = mass_kg;
  RobotModel robot;
  robot.joints = {joint};
  robot.gravity_W.setZero();
  return robot;
}

RobotModel randomChain(int n, unsigned seed) { return randomRobot(n, seed, true); }

RobotModel randomRevoluteChain(int n, unsigned seed) { return randomRobot(n, seed, false); }

}  // namespace baton::test
