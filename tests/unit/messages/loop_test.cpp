/// The loop's signals through their messages and back: nothing is lost, nothing bad passes, nothing allocates.
#include "messages/loop.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "support/allocation_guard.hpp"
#include "support/robots.hpp"

namespace baton {
namespace {

using test::randomJointVector;
using test::uniform;

constexpr StepStamp kStamp{.step = 12'345'678'901, .time_ns = 6'172'839'450'500'000};

/// The orientation travels as a unit quaternion, whose square gives the matrix back. Each of its four numbers is off by
/// a few roundings, at most 4 epsilon; each entry of R is a sum of products 2 q_i q_j with |q| = 1, so it is off by at
/// most 4 sqrt(2) times that, and a few roundings of its own.
constexpr double kRotationTolerance = 30 * std::numeric_limits<double>::epsilon();  // 6.7e-15

const std::vector<double> kNotFinite{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity()};

Matrix3 randomRotation(std::mt19937& generator) {
  Eigen::Vector4d v;
  do {
    for (double& x : v) x = uniform(generator, -1.0, 1.0);
  } while (v.norm() < 0.1);
  v.normalize();
  return Eigen::Quaterniond(v).toRotationMatrix();
}

/// Numbers of every magnitude that is accepted, so that a conversion through anything narrower than a double would
/// show.
template <typename Vector>
Vector wild(std::mt19937& generator, Eigen::Index rows = Vector::RowsAtCompileTime) {
  Vector v(rows);
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    v(i) = std::ldexp(uniform(generator, -1.0, 1.0), static_cast<int>(generator() % 139) - 100);
  }
  return v;
}

Matrix3 wildMatrix(std::mt19937& generator) {
  Matrix3 m;
  for (int i = 0; i < 3; ++i) m.col(i) = wild<Vector3>(generator);
  return m;
}

RobotState randomState(std::mt19937& generator, int n) {
  RobotState state;
  state.q = wild<JointVector>(generator, n);
  state.qd = wild<JointVector>(generator, n);
  state.tau_applied = wild<JointVector>(generator, n);
  state.X_WE = {randomRotation(generator), wild<Vector3>(generator)};
  state.V_WE = wild<Vector6>(generator);
  return state;
}

Contact randomContact(std::mt19937& generator) {
  Contact contact;
  contact.h_e = wild<Vector6>(generator);
  contact.df_dp = wildMatrix(generator);
  contact.df_dv = wildMatrix(generator);
  contact.penetration = uniform(generator, 0.0, 1.0);
  return contact;
}

Reference randomReference(std::mt19937& generator, int n) {
  Reference reference;
  reference.q = wild<JointVector>(generator, n);
  reference.qd = wild<JointVector>(generator, n);
  reference.qdd = wild<JointVector>(generator, n);
  reference.has_task = generator() % 2 == 0;
  reference.X_WE = {randomRotation(generator), wild<Vector3>(generator)};
  reference.V_WE = wild<Vector6>(generator);
  reference.A_WE = wild<Vector6>(generator);
  reference.h_d = wild<Vector6>(generator);
  return reference;
}

TEST(LoopMessages, AStateSurvivesTheRoundTrip) {
  std::mt19937 generator(1);
  msg::PlantState message;
  for (int i = 0; i < 200; ++i) {
    const int n = 1 + i % kMaxJoints;
    const RobotState state = randomState(generator, n);
    toMessage(kStamp, state, "joint_pd", 0xFEDC'BA98'7654'3210, message);
    EXPECT_EQ(message.step(), kStamp.step);
    EXPECT_EQ(message.time_ns(), kStamp.time_ns);
    EXPECT_STREQ(message.holder().c_str(), "joint_pd");
    EXPECT_EQ(message.chain_hash(), 0xFEDC'BA98'7654'3210);
    RobotState back;
    ASSERT_TRUE(fromMessage(message, n, back));
    EXPECT_EQ(back.q, state.q);
    EXPECT_EQ(back.qd, state.qd);
    EXPECT_EQ(back.tau_applied, state.tau_applied);
    EXPECT_EQ(back.X_WE.p, state.X_WE.p);
    EXPECT_EQ(back.V_WE, state.V_WE);
    EXPECT_LT((back.X_WE.R - state.X_WE.R).cwiseAbs().maxCoeff(), kRotationTolerance);
  }
}

TEST(LoopMessages, AContactSurvivesTheRoundTripExactly) {
  std::mt19937 generator(2);
  msg::Contact message;
  for (int i = 0; i < 200; ++i) {
    const Contact contact = randomContact(generator);
    toMessage(kStamp, contact, message);
    EXPECT_EQ(message.step(), kStamp.step);
    EXPECT_EQ(message.time_ns(), kStamp.time_ns);
    Contact back;
    ASSERT_TRUE(fromMessage(message, back));
    EXPECT_EQ(back.h_e, contact.h_e);
    EXPECT_EQ(back.df_dp, contact.df_dp);
    EXPECT_EQ(back.df_dv, contact.df_dv);
    EXPECT_EQ(back.penetration, contact.penetration);
  }
}

TEST(LoopMessages, DerivativesTravelRowByRow) {
  Contact contact;
  contact.df_dp << 0, 1, 2, 3, 4, 5, 6, 7, 8;
  contact.df_dv = 10.0 * contact.df_dp;
  msg::Contact message;
  toMessage(kStamp, contact, message);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(message.force_by_position()[i], static_cast<double>(i));
    EXPECT_EQ(message.force_by_velocity()[i], 10.0 * static_cast<double>(i));
  }
}

TEST(LoopMessages, AReferenceSurvivesTheRoundTrip) {
  std::mt19937 generator(3);
  msg::Reference message;
  for (int i = 0; i < 200; ++i) {
    const int n = 1 + i % kMaxJoints;
    const Reference reference = randomReference(generator, n);
    toMessage(kStamp, reference, message);
    EXPECT_EQ(message.step(), kStamp.step);
    EXPECT_EQ(message.time_ns(), kStamp.time_ns);
    Reference back;
    ASSERT_TRUE(fromMessage(message, n, back));
    EXPECT_EQ(back.q, reference.q);
    EXPECT_EQ(back.qd, reference.qd);
    EXPECT_EQ(back.qdd, reference.qdd);
    EXPECT_EQ(back.has_task, reference.has_task);
    EXPECT_EQ(back.X_WE.p, reference.X_WE.p);
    EXPECT_EQ(back.V_WE, reference.V_WE);
    EXPECT_EQ(back.A_WE, reference.A_WE);
    EXPECT_EQ(back.h_d, reference.h_d);
    EXPECT_LT((back.X_WE.R - reference.X_WE.R).cwiseAbs().maxCoeff(), kRotationTolerance);
  }
}

TEST(LoopMessages, AReferenceInTaskSpaceAloneHasNoJoints) {
  std::mt19937 generator(4);
  Reference reference = randomReference(generator, 0);
  reference.has_task = true;
  msg::Reference message;
  toMessage(kStamp, randomReference(generator, 3), message);  // what the reused message held before
  toMessage(kStamp, reference, message);
  Reference back = randomReference(generator, 3);
  ASSERT_TRUE(fromMessage(message, 3, back));
  EXPECT_EQ(back.q.size(), 0);
  EXPECT_EQ(back.qd.size(), 0);
  EXPECT_EQ(back.qdd.size(), 0);
  EXPECT_EQ(back.X_WE.p, reference.X_WE.p);
}

TEST(LoopMessages, AReferenceWithSomeJointSequencesAloneIsRefused) {
  std::mt19937 generator(5);
  for (int given = 1; given < 7; ++given) {  // bit i: sequence i is there
    msg::Reference message;
    toMessage(kStamp, randomReference(generator, 3), message);
    if ((given & 1) == 0) message.position().clear();
    if ((given & 2) == 0) message.velocity().clear();
    if ((given & 4) == 0) message.acceleration().clear();
    Reference back;
    EXPECT_FALSE(fromMessage(message, 3, back)) << given;
  }
}

TEST(LoopMessages, ACommandSurvivesTheRoundTripExactly) {
  std::mt19937 generator(6);
  msg::JointCommand message;
  for (int i = 0; i < 200; ++i) {
    const int n = 1 + i % kMaxJoints;
    const JointVector effort = wild<JointVector>(generator, n);
    toMessage(kStamp, "force_pi", effort, 42, message);
    EXPECT_EQ(message.step(), kStamp.step);
    EXPECT_EQ(message.time_ns(), kStamp.time_ns);
    EXPECT_STREQ(message.controller().c_str(), "force_pi");
    EXPECT_EQ(message.inputs_hash(), 42u);
    JointVector back;
    ASSERT_TRUE(fromMessage(message, n, back));
    EXPECT_EQ(back, effort);
  }
}

TEST(LoopMessages, TheEndsOfTheNumberLineSurvive) {
  const JointVector ends =
      (JointVector(5) << -0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::min(),
       std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest())
          .finished();
  std::vector<double> sequence;
  assignSequence(ends, sequence);
  JointVector back;
  ASSERT_TRUE(readSequence(sequence, 5, back));
  EXPECT_EQ(back, ends);
  EXPECT_TRUE(std::signbit(back(0)));
}

TEST(LoopMessages, AnyOtherNumberOfJointsIsRefused) {
  std::mt19937 generator(7);
  constexpr int kJoints = 3;
  for (std::size_t size = 0; size <= 2 * kMaxJoints; ++size) {
    if (size == kJoints) continue;
    const std::vector<double> wrong(size, 0.5);
    JointVector effort;
    EXPECT_FALSE(readSequence(wrong, kJoints, effort)) << size;

    msg::JointCommand command;
    command.effort(wrong);
    EXPECT_FALSE(fromMessage(command, kJoints, effort)) << size;

    for (int field = 0; field < 3; ++field) {
      msg::PlantState plant;
      toMessage(kStamp, randomState(generator, kJoints), "", 0, plant);
      (field == 0 ? plant.position() : field == 1 ? plant.velocity() : plant.applied_effort()) = wrong;
      RobotState state;
      EXPECT_FALSE(fromMessage(plant, kJoints, state)) << size << " in field " << field;

      msg::Reference desired;
      toMessage(kStamp, randomReference(generator, kJoints), desired);
      (field == 0 ? desired.position() : field == 1 ? desired.velocity() : desired.acceleration()) = wrong;
      Reference reference;
      EXPECT_FALSE(fromMessage(desired, kJoints, reference)) << size << " in field " << field;
    }
  }
}

/// Where the numbers of a message are.
std::vector<double*> numbersOf(std::vector<double>& sequence) {
  std::vector<double*> result;
  result.reserve(sequence.size());
  for (double& x : sequence) result.push_back(&x);
  return result;
}
template <std::size_t kSize>
std::vector<double*> numbersOf(std::array<double, kSize>& values) {
  std::vector<double*> result;
  result.reserve(kSize);
  for (double& x : values) result.push_back(&x);
  return result;
}
std::vector<double*> numbersOf(msg::Quaternion& q) { return {&q.w(), &q.x(), &q.y(), &q.z()}; }

template <class... Fields>
std::vector<double*> numbersOfAll(Fields&... fields) {
  std::vector<double*> result;
  const auto append = [&](const std::vector<double*>& more) { result.insert(result.end(), more.begin(), more.end()); };
  (append(numbersOf(fields)), ...);
  return result;
}

/// Every number of a good message, one at a time, made not finite: each must be refused, and the message is good again
/// with the number put back.
template <class Message>
void expectEveryNumberChecked(Message& message, const std::vector<double*>& numbers, std::size_t expected_count,
                              const std::function<bool(const Message&)>& accepts) {
  ASSERT_EQ(numbers.size(), expected_count);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double good = *numbers[i];
    for (const double bad : kNotFinite) {
      *numbers[i] = bad;
      EXPECT_FALSE(accepts(message)) << "number " << i << " = " << bad;
    }
    *numbers[i] = good;
    ASSERT_TRUE(accepts(message));
  }
}

TEST(LoopMessages, NoNumberOfAStateMayBeNotFinite) {
  std::mt19937 generator(8);
  msg::PlantState m;
  toMessage(kStamp, randomState(generator, 3), "x", 0, m);
  const auto numbers = numbersOfAll(m.position(), m.velocity(), m.applied_effort(), m.tip_position(),
                                    m.tip_orientation(), m.tip_velocity(), m.tip_angular_velocity());
  expectEveryNumberChecked<msg::PlantState>(m, numbers, 3 * 3 + 3 + 4 + 6, [](const msg::PlantState& message) {
    RobotState state;
    return bool{fromMessage(message, 3, state)};
  });
}

TEST(LoopMessages, NoNumberOfAContactMayBeNotFinite) {
  std::mt19937 generator(9);
  msg::Contact m;
  toMessage(kStamp, randomContact(generator), m);
  auto numbers = numbersOfAll(m.force(), m.moment(), m.force_by_position(), m.force_by_velocity());
  numbers.push_back(&m.penetration());
  expectEveryNumberChecked<msg::Contact>(m, numbers, 6 + 18 + 1, [](const msg::Contact& message) {
    Contact contact;
    return bool{fromMessage(message, contact)};
  });
}

TEST(LoopMessages, NoNumberOfAReferenceMayBeNotFinite) {
  std::mt19937 generator(10);
  msg::Reference m;
  toMessage(kStamp, randomReference(generator, 3), m);
  const auto numbers = numbersOfAll(m.position(), m.velocity(), m.acceleration(), m.tip_position(), m.tip_orientation(),
                                    m.tip_velocity(), m.tip_angular_velocity(), m.tip_acceleration(),
                                    m.tip_angular_acceleration(), m.force(), m.moment());
  expectEveryNumberChecked<msg::Reference>(m, numbers, 3 * 3 + 3 + 4 + 12 + 6, [](const msg::Reference& message) {
    Reference reference;
    return bool{fromMessage(message, 3, reference)};
  });
}

TEST(LoopMessages, NoNumberOfACommandMayBeNotFinite) {
  std::mt19937 generator(11);
  msg::JointCommand m;
  toMessage(kStamp, "x", randomJointVector(generator, 3, 1.0), 0, m);
  expectEveryNumberChecked<msg::JointCommand>(m, numbersOfAll(m.effort()), 3, [](const msg::JointCommand& message) {
    JointVector effort;
    return bool{fromMessage(message, 3, effort)};
  });
}

TEST(LoopMessages, WhatIsRefusedNamesItsFieldAndWhatIsWrongWithIt) {
  std::mt19937 generator(15);
  msg::Reference reference;
  toMessage(kStamp, randomReference(generator, 3), reference);
  Reference wanted;
  EXPECT_EQ(fromMessage(reference, 3, wanted).text(), "");
  EXPECT_EQ(fromMessage(reference, 4, wanted).text(), "position has not one entry a joint");
  reference.tip_acceleration()[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fromMessage(reference, 3, wanted).text(), "tip_acceleration is not finite");
  reference.acceleration()[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fromMessage(reference, 3, wanted).text(), "acceleration is not finite") << "the first one";

  msg::PlantState plant;
  toMessage(kStamp, randomState(generator, 3), "x", 0, plant);
  plant.tip_orientation().w(2.0);
  RobotState state;
  EXPECT_EQ(fromMessage(plant, 3, state).text(), "tip_orientation is no unit quaternion");
  msg::Contact contact;
  contact.force_by_velocity()[8] = -std::numeric_limits<double>::infinity();
  Contact touch;
  EXPECT_EQ(fromMessage(contact, touch).text(), "force_by_velocity is not finite");
  contact.penetration(-1e300);
  EXPECT_EQ(fromMessage(contact, touch).text(), "penetration is beyond 1e12");
  msg::JointCommand command;
  command.effort({1.0, 2.0});
  JointVector effort;
  EXPECT_EQ(fromMessage(command, 3, effort).text(), "effort has not one entry a joint");
  command.effort({1.0, 1e12, 2e12});
  EXPECT_EQ(fromMessage(command, 3, effort).text(), "effort is beyond 1e12");
  command.effort({1.0, 1e12, -1e12});
  EXPECT_EQ(fromMessage(command, 3, effort).text(), "");
}

TEST(LoopMessages, AQuaternionThatIsNoRotationIsRefused) {
  std::mt19937 generator(12);
  msg::PlantState message;
  toMessage(kStamp, randomState(generator, 3), "", 0, message);
  const msg::Quaternion unit = message.tip_orientation();
  RobotState state;
  for (const double scale : {0.0, 0.5, 0.999, 1.001, 2.0, 1e200}) {
    message.tip_orientation().w(scale * unit.w());
    message.tip_orientation().x(scale * unit.x());
    message.tip_orientation().y(scale * unit.y());
    message.tip_orientation().z(scale * unit.z());
    EXPECT_FALSE(fromMessage(message, 3, state)) << scale;
  }
}

TEST(LoopMessages, AQuaternionUnitToSinglePrecisionStillGivesARotation) {
  // What a sender that computes in float would send.
  std::mt19937 generator(13);
  msg::PlantState message;
  for (int i = 0; i < 100; ++i) {
    toMessage(kStamp, randomState(generator, 3), "", 0, message);
    msg::Quaternion& q = message.tip_orientation();
    for (double* number : numbersOf(q)) *number = static_cast<double>(static_cast<float>(*number));
    RobotState state;
    ASSERT_TRUE(fromMessage(message, 3, state));
    const Matrix3 should_be_identity = state.X_WE.R.transpose() * state.X_WE.R;
    EXPECT_LT((should_be_identity - Matrix3::Identity()).norm(), kRotationTolerance);
    EXPECT_GT(state.X_WE.R.determinant(), 0.0);
  }
}

TEST(LoopMessages, NothingAllocatesAfterPrepare) {
  if (!test::AllocationGuard::isActive()) GTEST_SKIP() << "the sanitizer's malloc cannot be counted";
  std::mt19937 generator(14);
  const std::string name(msg::MAX_NAME, 'x');
  for (const int n : {0, 1, 3, kMaxJoints}) {
    msg::PlantState plant;
    msg::Contact touch;
    msg::Reference desired;
    msg::JointCommand command;
    prepare(plant);
    prepare(desired);
    prepare(command);
    RobotState state = randomState(generator, n);
    Contact contact = randomContact(generator);
    Reference reference = randomReference(generator, n);
    JointVector effort = randomJointVector(generator, n, 1.0);
    const test::AllocationGuard guard;
    toMessage(kStamp, state, name, 1, plant);
    toMessage(kStamp, contact, touch);
    toMessage(kStamp, reference, desired);
    toMessage(kStamp, name, effort, 1, command);
    const bool good = fromMessage(plant, n, state) && fromMessage(touch, contact) &&
                      fromMessage(desired, n, reference) && fromMessage(command, n, effort);
    EXPECT_EQ(guard.count(), 0u) << n << " joints";
    EXPECT_TRUE(good);
  }
}

}  // namespace
}  // namespace baton
