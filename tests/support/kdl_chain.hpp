/// The same arm for orocos-kdl.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/jntarray.hpp>

#include "robot/model.hpp"

namespace baton::test {

[[nodiscard]] inline KDL::Vector toKdl(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

[[nodiscard]] inline KDL::JntArray toKdl(const JointVector& v) {
  KDL::JntArray array(static_cast<unsigned>(v.size()));
  array.data = v;
  return array;
}

[[nodiscard]] inline KDL::Frame toKdl(const DhRow& row) {
  return KDL::Frame::DH(row.a_m, row.alpha_rad, row.d_m, row.theta_rad);
}

/// A KDL segment is a joint followed by a fixed frame, which is a distal DH row with the joint about or along its first
/// z; its inertia is about the centre of mass, in the frame at its end. The base adds a segment without a joint.
[[nodiscard]] inline KDL::Chain toKdl(const RobotModel& model) {
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), toKdl(model.base)));
  for (const Joint& joint : model.joints) {
    const Matrix3 I = joint.link.inertiaAtCentreOfMass();
    const KDL::RigidBodyInertia inertia(joint.link.mass_kg, toKdl(joint.link.centreOfMass()),
                                        KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
    const auto type = joint.kind == JointKind::kRevolute ? KDL::Joint::RotZ : KDL::Joint::TransZ;
    chain.addSegment(KDL::Segment(KDL::Joint(type), toKdl(joint.dh), inertia));
  }
  return chain;
}

}  // namespace baton::test
