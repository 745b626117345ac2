/// Robot files: a chain of joints in YAML, as deploy/robots/*.yaml document it, to a checked RobotModel.
#include <algorithm>

#include "base/error.hpp"
#include "runtime/scenario.hpp"
#include "runtime/yaml.hpp"

namespace baton {
namespace {

// Wide enough for any arm, narrow enough to catch a slip of units or of a decimal point.
const NumberRange kLength{-100.0, 100.0, "m"};
const NumberRange kAngle{-100.0, 100.0, "rad"};
const NumberRange kGravity{-1000.0, 1000.0, "m/s^2"};
const NumberRange kMass{-1e5, 1e5, "kg"};  // a negative one is for checkModel to judge
const NumberRange kInertia{-1e6, 1e6, "kg m^2"};
const NumberRange kFriction{0.0, 1e6, "N m s/rad, N s/m, N m or N"};
const NumberRange kFrictionVelocity{1e-9, 1e3, "rad/s or m/s"};
const NumberRange kEffortLimit{0.0, 1e9, "N m or N", true};

/// Missing lengths and angles are 0.
DhRow readDhRow(const YamlNode& node) {
  const YamlMap row = node.map({"a_m", "alpha_rad", "theta_rad", "d_m"});
  return {.a_m = row.numberOr("a_m", kLength, 0.0),
          .alpha_rad = row.numberOr("alpha_rad", kAngle, 0.0),
          .theta_rad = row.numberOr("theta_rad", kAngle, 0.0),
          .d_m = row.numberOr("d_m", kLength, 0.0)};
}

/// Missing components are 0.
Matrix3 readInertia(const YamlNode& node) {
  const YamlMap tensor = node.map({"xx", "yy", "zz", "xy", "xz", "yz"});
  const auto component = [&](const char* key) { return tensor.numberOr(key, kInertia, 0.0); };
  // All of them first: a comma initialiser that an exception leaves half filled ends the program.
  const double xx = component("xx"), yy = component("yy"), zz = component("zz");
  const double xy = component("xy"), xz = component("xz"), yz = component("yz");
  Matrix3 inertia;
  inertia << xx, xy, xz,  //
      xy, yy, yz,         //
      xz, yz, zz;
  return inertia;
}

LinkInertia readLink(const YamlNode& node) {
  const YamlMap link = node.map({"mass_kg", "com_m", "inertia_com_kg_m2", "inertia_origin_kg_m2"});
  const double mass = link["mass_kg"].number(kMass);
  const Vector3 com = link["com_m"].vector3(kLength);
  const auto at_com = link.find("inertia_com_kg_m2");
  const auto at_origin = link.find("inertia_origin_kg_m2");
  if (at_com.has_value() == at_origin.has_value()) {
    node.fail(
        "expected either inertia_com_kg_m2 (about the centre of mass) or inertia_origin_kg_m2 (about the link's "
        "frame), found " +
        std::string(at_com ? "both" : "neither"));
  }
  if (at_com) return LinkInertia::fromCentreOfMass(mass, com, readInertia(*at_com));
  return {mass, mass * com, readInertia(*at_origin)};
}

JointFriction readFriction(const YamlNode& node) {
  const YamlMap friction = node.map({"viscous", "coulomb", "coulomb_velocity"});
  JointFriction read;
  read.viscous = friction.numberOr("viscous", kFriction, read.viscous);
  read.coulomb = friction.numberOr("coulomb", kFriction, read.coulomb);
  read.coulomb_velocity = friction.numberOr("coulomb_velocity", kFrictionVelocity, read.coulomb_velocity);
  return read;
}

Joint readJoint(const YamlNode& node) {
  const YamlMap map = node.map({"name", "kind", "dh", "link", "friction", "effort_limit"});
  Joint joint;
  joint.name = map["name"].name();
  joint.kind = map["kind"].oneOf<JointKind>({{"revolute", JointKind::kRevolute}, {"prismatic", JointKind::kPrismatic}});
  joint.dh = readDhRow(map["dh"]);
  joint.link = readLink(map["link"]);
  if (const auto friction = map.find("friction")) joint.friction = readFriction(*friction);
  joint.effort_limit = map.numberOr("effort_limit", kEffortLimit, joint.effort_limit);
  return joint;
}

}  // namespace

RobotModel parseRobot(const std::string& file, const std::string& text, std::vector<std::string>* warnings) {
  const YamlMap map = YamlNode::parse(file, text).map({"name", "gravity_m_per_s2", "base", "joints"});
  RobotModel robot;
  robot.name = map["name"].name();
  robot.gravity_W = map["gravity_m_per_s2"].vector3(kGravity);
  if (const auto base = map.find("base")) robot.base = readDhRow(*base);
  for (const YamlNode& node : map["joints"].list(1, kMaxJoints)) {
    Joint joint = readJoint(node);
    const auto has_its_name = [&](const Joint& other) { return other.name == joint.name; };
    if (std::any_of(robot.joints.begin(), robot.joints.end(), has_its_name)) {
      node.fail("expected a name of its own for each joint, found a second '" + joint.name + "'");
    }
    robot.joints.push_back(std::move(joint));
  }

  const std::string place = map["joints"].place();
  try {
    for (const std::string& warning : checkModel(robot)) {
      if (warnings != nullptr) warnings->push_back(place + warning);
    }
  } catch (const UsageError& error) {
    throw UsageError(place + error.what());
  }
  return robot;
}

RobotModel loadRobot(const std::string& path, std::vector<std::string>* warnings) {
  return parseRobot(path, readYamlFile(path), warnings);
}

}  // namespace baton
