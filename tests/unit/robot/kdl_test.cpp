/// A second opinion from an independent implementation: Orocos KDL.
#include <gtest/gtest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <random>

#include "robot/dynamics.hpp"
#include "robot/kinematics.hpp"
#include "support/kdl_chain.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::toKdl;

constexpr double kTolerance = 1e-10;  // of the magnitude; both sides round at about 1e-15 per operation

template <typename A, typename B>
void expectClose(const A& actual, const B& expected) {
  EXPECT_LT((actual - expected).norm(), kTolerance * (1.0 + expected.norm()));
}

class Kdl : public testing::TestWithParam<int> {};

TEST_P(Kdl, AgreesAtAThousandStates) {
  const int n = GetParam();
  const RobotModel model = n == 0 ? test::rppRobot() : test::randomChain(n, 1000 + n);
  const KDL::Chain chain = toKdl(model);
  KDL::ChainFkSolverPos_recursive position(chain);
  KDL::ChainIdSolver_RNE newton_euler(chain, toKdl(model.gravity_W));
  KDL::ChainDynParam terms(chain, toKdl(model.gravity_W));
  KDL::JntArray tau_kdl(model.size()), coriolis_kdl(model.size()), gravity_kdl(model.size());
  KDL::JntSpaceInertiaMatrix B_kdl(model.size());
  KDL::Wrenches wrenches(model.size() + 1, KDL::Wrench::Zero());

  std::mt19937 generator(n);
  for (int k = 0; k < 1000; ++k) {
    const JointVector q = test::randomJointVector(generator, model.size(), 3.0);
    const JointVector qd = test::randomJointVector(generator, model.size(), 2.0);
    const JointVector qdd = test::randomJointVector(generator, model.size(), 5.0);
    const Vector6 h_e = test::randomJointVector(generator, 6, 20.0);

    KDL::Frame X_kdl;
    ASSERT_EQ(position.JntToCart(toKdl(q), X_kdl), 0);
    const Pose X_WE = tipPose(model, q);
    expectClose(X_WE.p, Eigen::Map<const Vector3>(X_kdl.p.data));

    // The environment acts on the tip with -h_e; KDL wants that in the frame of the last segment.
    const KDL::Wrench on_tip(toKdl(Vector3(-h_e.head<3>())), toKdl(Vector3(-h_e.tail<3>())));
    wrenches.back() = X_kdl.M.Inverse() * on_tip;
    ASSERT_EQ(newton_euler.CartToJnt(toKdl(q), toKdl(qd), toKdl(qdd), wrenches, tau_kdl), 0);
    JointVector tau, bias, gravity;
    inverseDynamics(model, q, qd, qdd, h_e, tau);
    expectClose(tau, tau_kdl.data);

    ASSERT_EQ(terms.JntToMass(toKdl(q), B_kdl), 0);
    JointMatrix B;
    massMatrix(model, q, B);
    expectClose(B, B_kdl.data);

    ASSERT_EQ(terms.JntToCoriolis(toKdl(q), toKdl(qd), coriolis_kdl), 0);
    ASSERT_EQ(terms.JntToGravity(toKdl(q), gravity_kdl), 0);
    biasEffort(model, q, qd, bias);
    gravityEffort(model, q, gravity);
    expectClose(gravity, gravity_kdl.data);
    expectClose(JointVector(bias - gravity), coriolis_kdl.data);
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, Kdl, testing::Range(0, 8), [](const testing::TestParamInfo<int>& chain) {
  return chain.param == 0 ? std::string("Rpp") : "RandomChainOf" + std::to_string(chain.param);
});

}  // namespace
}  // namespace baton
