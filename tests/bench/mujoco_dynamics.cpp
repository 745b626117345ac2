#include "bench/mujoco_dynamics.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace baton::bench {
namespace {

Pose fromRow(const DhRow& row) {
  const Eigen::AngleAxisd theta(row.theta_rad, Vector3::UnitZ()), alpha(row.alpha_rad, Vector3::UnitX());
  return {(theta * alpha).toRotationMatrix(), theta * Vector3(row.a_m, 0.0, row.d_m)};
}

/// pos and quat attributes.
std::string placed(const Vector3& p, const Matrix3& R) {
  const Eigen::Quaterniond quaternion(R);
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << "pos='" << p.transpose() << "' quat='" << quaternion.w() << ' ' << quaternion.vec().transpose() << '\'';
  return text.str();
}

/// The link's mass and principal inertia, in the frame of its body, which is the frame of the joint at q = 0.
std::string inertial(const Joint& joint) {
  const Pose X_BL = fromRow(joint.dh);
  const Eigen::SelfAdjointEigenSolver<Matrix3> principal(joint.link.inertiaAtCentreOfMass());
  Matrix3 axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << "<inertial mass='" << joint.link.mass_kg << "' diaginertia='" << principal.eigenvalues().transpose() << "' "
       << placed(X_BL.p + X_BL.R * joint.link.centreOfMass(), X_BL.R * axes) << "/>";
  return text.str();
}

/// A body for each link, nested. A body sits where its joint is, and its joint is about or along its z; so a DH row
/// places the next body.
std::string toMjcf(const RobotModel& model) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << "<mujoco><compiler angle='radian'/><option gravity='" << model.gravity_W.transpose() << "'/><worldbody>";
  Pose X_PB = fromRow(model.base);
  for (const Joint& joint : model.joints) {
    const char* type = joint.kind == JointKind::kRevolute ? "hinge" : "slide";
    text << "<body " << placed(X_PB.p, X_PB.R) << ">" << inertial(joint) << "<joint type='" << type
         << "' axis='0 0 1'/>";
    X_PB = fromRow(joint.dh);
  }
  for (int i = 0; i < model.size(); ++i) text << "</body>";
  text << "</worldbody></mujoco>";
  return text.str();
}

mjModel* load(const std::string& mjcf) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "arm.xml", static_cast<int>(mjcf.size()));
  std::copy(mjcf.begin(), mjcf.end(), static_cast<char*>(files->filedata[mj_findFileVFS(files.get(), "arm.xml")]));
  char reason[1000] = "";
  mjModel* model = mj_loadXML("arm.xml", files.get(), reason, sizeof reason);
  mj_deleteFileVFS(files.get(), "arm.xml");
  if (model == nullptr) throw std::runtime_error("MuJoCo refuses the arm: " + std::string(reason));
  return model;
}

}  // namespace

MujocoDynamics::MujocoDynamics(const RobotModel& model, std::vector<DynamicState> states)
    : states_(std::move(states)),
      model_(load(toMjcf(model))),
      data_(mj_makeData(model_.get())),
      vector_(model.size()),
      g_(model.size()),
      B_(model.size(), model.size()) {}

}  // namespace baton::bench
