#include "robot/model.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "robot/dynamics.hpp"

namespace baton {
namespace {

/// |r|^2 1 - r r^T: the inertia about the origin of a unit mass at r.
Matrix3 unitMassInertia(const Vector3& r) { return r.squaredNorm() * Matrix3::Identity() - r * r.transpose(); }

bool isFinite(const DhRow& row) {
  return std::isfinite(row.a_m) && std::isfinite(row.alpha_rad) && std::isfinite(row.theta_rad) &&
         std::isfinite(row.d_m);
}

void require(bool condition, const std::string& message) {
  if (!condition) throw UsageError(message);
}

void checkJoint(const Joint& joint, const std::string& name) {
  const LinkInertia& link = joint.link;
  require(isFinite(joint.dh), name + ": its DH row has a number that is not finite");
  require(std::isfinite(link.mass_kg) && link.first_moment_kg_m.allFinite() && link.inertia_origin_kg_m2.allFinite(),
          name + ": its link's mass, first moment or inertia has a number that is not finite");
  require(link.inertia_origin_kg_m2.isApprox(link.inertia_origin_kg_m2.transpose(), 1e-9),
          name + ": its link's inertia is not a symmetric matrix");
  require(link.mass_kg != 0.0 || link.first_moment_kg_m.isZero(0.0),
          name + ": its link has a first moment but no mass; give the mass, or put the centre of mass at the origin");

  const JointFriction& friction = joint.friction;
  require(std::isfinite(friction.viscous) && friction.viscous >= 0.0,
          name + ": viscous friction must be finite and not negative");
  require(std::isfinite(friction.coulomb) && friction.coulomb >= 0.0,
          name + ": Coulomb friction must be finite and not negative");
  require(std::isfinite(friction.coulomb_velocity) && friction.coulomb_velocity > 0.0,
          name + ": the Coulomb friction's velocity must be finite and positive");
  require(joint.effort_limit >= 0.0, name + ": the effort limit must not be negative");
}

/// Mass negative, or principal moments of inertia that no distribution of mass has.
bool isPossibleBody(const LinkInertia& link) {
  const Vector3 principal = link.inertiaAtCentreOfMass().selfadjointView<Eigen::Lower>().eigenvalues();  // increasing
  const double rounding = 1e-9 * principal.cwiseAbs().maxCoeff();
  return link.mass_kg >= 0.0 && principal(0) + principal(1) >= principal(2) - rounding;
}

/// Positive definite by a margin above rounding, whatever the units of each joint: judged on the matrix scaled to a
/// unit diagonal.
bool isPositiveDefinite(const JointMatrix& B) {
  constexpr double kMargin = 1e-12;
  if (!B.allFinite() || B.diagonal().minCoeff() <= 0.0) return false;
  const JointVector scale = B.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * B * scale.asDiagonal();
  return scaled.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() > kMargin;
}

/// The k-th of a fixed sequence of configurations that spreads evenly over one turn or two metres of each joint:
/// multiples of an irrational number, a different one for each joint. The first is q = 0.
JointVector sampleConfiguration(const RobotModel& model, int k) {
  constexpr double kPi = 3.14159265358979323846;
  constexpr double kPrimes[kMaxJoints] = {2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0};
  JointVector q(model.size());
  for (int i = 0; i < model.size(); ++i) {
    const double range = model.joints[i].kind == JointKind::kRevolute ? kPi : 1.0;
    q(i) = range * std::remainder(k * std::sqrt(kPrimes[i]), 1.0) * 2.0;
  }
  return q;
}

}  // namespace

Angle::Angle(double rad) : rad_(rad), sine_(elementary::sin(rad)), cosine_(elementary::cos(rad)) {
  constexpr double kRounding = 4e-16;  // of pi/2, pi and 3 pi/2 as doubles, and of the sine and cosine themselves
  if (std::abs(sine_) < kRounding) {
    sine_ = 0.0;
    cosine_ = cosine_ < 0.0 ? -1.0 : 1.0;
  } else if (std::abs(cosine_) < kRounding) {
    sine_ = sine_ < 0.0 ? -1.0 : 1.0;
    cosine_ = 0.0;
  }
}

LinkInertia LinkInertia::fromCentreOfMass(double mass_kg, const Vector3& com_m, const Matrix3& inertia_com_kg_m2) {
  return {mass_kg, mass_kg * com_m, inertia_com_kg_m2 + mass_kg * unitMassInertia(com_m)};
}

Vector3 LinkInertia::centreOfMass() const {
  if (mass_kg == 0.0) return Vector3::Zero();
  return first_moment_kg_m / mass_kg;
}

Matrix3 LinkInertia::inertiaAtCentreOfMass() const {
  return inertia_origin_kg_m2 - mass_kg * unitMassInertia(centreOfMass());
}

std::vector<std::string> checkModel(const RobotModel& model) {
  const std::string robot = "robot '" + model.name + "'";
  require(model.size() >= 1 && model.size() <= kMaxJoints,
          robot + ": expected 1 to " + std::to_string(kMaxJoints) + " joints, found " + std::to_string(model.size()));
  require(isFinite(model.base), robot + ": the base's DH row has a number that is not finite");
  require(model.gravity_W.allFinite(), robot + ": gravity has a number that is not finite");

  std::vector<std::string> warnings;
  for (int i = 0; i < model.size(); ++i) {
    const Joint& joint = model.joints[i];
    const std::string name = robot + ", joint " + std::to_string(i + 1) + " '" + joint.name + "'";
    checkJoint(joint, name);
    if (!isPossibleBody(joint.link)) {
      warnings.push_back(name +
                         ": its link is not a possible rigid body (negative mass, or an inertia about its centre "
                         "of mass that breaks the triangle inequality); its equations are used as given.");
    }
  }

  constexpr int kConfigurations = 64;
  JointMatrix B;
  for (int k = 0; k < kConfigurations; ++k) {
    const JointVector q = sampleConfiguration(model, k);
    massMatrix(model, q, B);
    if (isPositiveDefinite(B)) continue;
    std::string where;
    for (int i = 0; i < model.size(); ++i) where += (i > 0 ? ", " : "") + std::to_string(q(i));
    throw UsageError(robot + ": the mass matrix is not positive definite at q = (" + where +
                     "), so the arm cannot be simulated; check the masses and inertias of its links");
  }
  return warnings;
}

}  // namespace baton
