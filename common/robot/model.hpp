/// The robot as data: a serial chain of 1 to kMaxJoints joints in standard (distal) Denavit-Hartenberg convention.
/// Immutable once loaded and shared by whoever computes with it; see kinematics.hpp and dynamics.hpp.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/types.hpp"

namespace baton {

enum class JointKind { kRevolute, kPrismatic };

/// A constant angle with its sine and cosine, computed once; a plain double in every other way. Quarter turns are
/// exact: cos(pi/2) is 0 and not 6e-17, so that an axis meant to be level is level.
class Angle {
 public:
  Angle(double rad = 0.0);  // NOLINT(google-explicit-constructor): an angle in rad is a number
  operator double() const { return rad_; }
  [[nodiscard]] double sine() const { return sine_; }
  [[nodiscard]] double cosine() const { return cosine_; }

 private:
  double rad_;
  double sine_;
  double cosine_;
};

/// One DH row. The joint variable is added to theta (revolute) or d (prismatic).
/// A = Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha); Siciliano et al. (2009), eq. 2.52.
struct DhRow {
  double a_m = 0.0;
  Angle alpha_rad;
  Angle theta_rad;
  double d_m = 0.0;
};

/// Standard dynamic parameters of a link, in its own DH frame (the frame at its far end).
/// Linear in the dynamics, so the same numbers serve an adaptive law's regressor.
struct LinkInertia {
  double mass_kg = 0.0;
  Vector3 first_moment_kg_m = Vector3::Zero();     // mass x centre of mass
  Matrix3 inertia_origin_kg_m2 = Matrix3::Zero();  // about the frame's origin

  /// From the centre of mass and the inertia about it (parallel axes, once).
  static LinkInertia fromCentreOfMass(double mass_kg, const Vector3& com_m, const Matrix3& inertia_com_kg_m2);
  /// Zero vector for a massless link.
  [[nodiscard]] Vector3 centreOfMass() const;
  [[nodiscard]] Matrix3 inertiaAtCentreOfMass() const;
};

/// Friction effort = viscous qd + coulomb tanh(qd / coulomb_velocity): Coulomb's sign, made smooth so that it can be
/// integrated.
struct JointFriction {
  double viscous = 0.0;            // N m s/rad or N s/m
  double coulomb = 0.0;            // N m or N
  double coulomb_velocity = 1e-3;  // rad/s or m/s, positive
};

struct Joint {
  std::string name;
  JointKind kind = JointKind::kRevolute;
  DhRow dh;
  LinkInertia link;
  JointFriction friction;
  double effort_limit = std::numeric_limits<double>::infinity();  // |tau| is cut here [N m or N]
};

struct RobotModel {
  std::string name;
  DhRow base;                           // fixed transform from the world to joint 1's frame
  std::vector<Joint> joints;            // 1 to kMaxJoints
  Vector3 gravity_W{0.0, 0.0, -9.806};  // m/s^2

  [[nodiscard]] int size() const { return static_cast<int>(joints.size()); }
};

/// Checks that the model can be simulated. Throws UsageError naming the joint or link when it cannot: no joints or too
/// many, a number that is not finite, a negative friction or limit, an inertia that is not symmetric, a first moment
/// without a mass, or a mass matrix that is not positive definite at one of a fixed set of configurations.
/// Returns warnings, one sentence each, for what is odd but workable: a link that is not a possible rigid body
/// (negative mass, or an inertia about its centre of mass that breaks the triangle inequality).
[[nodiscard]] std::vector<std::string> checkModel(const RobotModel& model);

}  // namespace baton
