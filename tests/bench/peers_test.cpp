/// A third opinion on the dynamics beside Lagrange's road and Orocos KDL: MuJoCo. And that the benchmark's libraries
/// compute the same thing, each by every call that is timed.
#include <gtest/gtest.h>

#include "bench/agreement.hpp"
#include "bench/kdl_dynamics.hpp"
#include "bench/mujoco_dynamics.hpp"

namespace baton::bench {
namespace {

class Peers : public testing::TestWithParam<int> {
 protected:
  static constexpr int kStates = 1000;
  const RobotModel model = GetParam() == 0 ? test::rppRobot() : test::randomChain(GetParam(), 2000 + GetParam());
  const std::vector<DynamicState> states = randomStates(model.size(), kStates, GetParam());
  BatonDynamics ours{model, states};
};

TEST_P(Peers, MujocoAgreesAtAThousandStates) {
  MujocoDynamics mujoco(model, states);
  EXPECT_LT(largestDistance(ours, mujoco, kStates), kAgreement);
}

TEST_P(Peers, OrocosKdlAgreesAtAThousandStates) {
  KdlDynamics kdl(model, states);
  EXPECT_LT(largestDistance(ours, kdl, kStates), kAgreement);
}

INSTANTIATE_TEST_SUITE_P(Joints, Peers, testing::Range(0, 8), [](const testing::TestParamInfo<int>& chain) {
  return chain.param == 0 ? std::string("Rpp") : "RandomChainOf" + std::to_string(chain.param);
});

}  // namespace
}  // namespace baton::bench
