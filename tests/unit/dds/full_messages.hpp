/// One message of every type, filled to its bounds: the longest payload each can have. A new type needs one function
/// here; the codec's tests notice when it is missing.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "msg/cdr.hpp"
#include "msg/checkpoint.h"
#include "msg/decision.h"
#include "msg/loop.h"
#include "msg/parameter.h"
#include "msg/record.h"
#include "msg/service.h"
#include "msg/sim.h"
#include "msg/swap.h"

namespace baton::test {

using AllTypes =
    testing::Types<msg::Quaternion, msg::PlantState, msg::Contact, msg::Reference, msg::JointCommand, msg::Checkpoint,
                   msg::SimRequest, msg::SimReply, msg::SimStatus, msg::TimeSpread, msg::StepSpread, msg::TimingStatus,
                   msg::Rewind, msg::RewindAck, msg::SwapRequest, msg::SwapPlan, msg::SwapAck, msg::SwapOutcome,
                   msg::SwapReport, msg::BatonMember, msg::BatonStatus, msg::ControllerStatus, msg::Parameter,
                   msg::ParameterStatus, msg::ParameterValue, msg::ParameterRequest, msg::ParameterReply, msg::Decision,
                   msg::LaunchRequest, msg::LaunchReply, msg::ServiceStatus, msg::Event, msg::StreamManifest,
                   msg::ServiceManifest, msg::WriterLoss, msg::RecorderStatus, msg::RecordRequest, msg::RecordReply,
                   msg::ReplayStatus, msg::ReplayRequest, msg::ReplayReply>;

/// Header and body of a message's payload, without the filling up to a multiple of four.
template <class T>
std::size_t unfilledSize(const T& message) {
  msg::FastBuffer growing;
  msg::PlainCdr cdr(growing);
  cdr.serialize_encapsulation();
  cdr << message;
  return cdr.length();
}

inline constexpr std::uint64_t kId = 0xFEDC'BA98'7654'3210;
inline constexpr std::int64_t kTime = -0x0123'4567'89AB'CDEF;

inline std::string fullName() { return std::string(msg::MAX_NAME, 'n'); }
inline std::vector<double> fullSequence() { return std::vector<double>(msg::MAX_JOINTS, -1.0 / 3.0); }
inline constexpr std::array<double, 3> kThree{0.1, -2e300, 3e-300};
inline constexpr std::array<double, 9> kNine{1, 2, 3, 4, 5, 6, 7, 8, 9};

inline void fill(msg::Quaternion& m) {
  m.w(0.5);
  m.x(-0.5);
  m.y(0.5);
  m.z(-0.5);
}

inline void fill(msg::PlantState& m) {
  m.step(kId);
  m.time_ns(kTime);
  m.position(fullSequence());
  m.velocity(fullSequence());
  m.applied_effort(fullSequence());
  m.tip_position(kThree);
  fill(m.tip_orientation());
  m.tip_velocity(kThree);
  m.tip_angular_velocity(kThree);
  m.holder(fullName());
  m.checkpoint(true);
  m.chain_hash(kId);
}

inline void fill(msg::Contact& m) {
  m.step(kId);
  m.time_ns(kTime);
  m.force(kThree);
  m.moment(kThree);
  m.force_by_position(kNine);
  m.force_by_velocity(kNine);
  m.penetration(0.25);
}

inline void fill(msg::Reference& m) {
  m.step(kId);
  m.time_ns(kTime);
  m.position(fullSequence());
  m.velocity(fullSequence());
  m.acceleration(fullSequence());
  m.has_task(true);
  m.tip_position(kThree);
  fill(m.tip_orientation());
  m.tip_velocity(kThree);
  m.tip_angular_velocity(kThree);
  m.tip_acceleration(kThree);
  m.tip_angular_acceleration(kThree);
  m.force(kThree);
  m.moment(kThree);
}

inline void fill(msg::JointCommand& m) {
  m.step(kId);
  m.time_ns(kTime);
  m.controller(fullName());
  m.effort(fullSequence());
  m.inputs_hash(kId);
}

inline void fill(msg::Checkpoint& m) {
  m.step(kId);
  m.time_ns(kTime);
  m.name(fullName());
  m.state().resize(msg::MAX_CHECKPOINT, 0xC5);
}

inline void fill(msg::SimRequest& m) {
  m.request_id(kId);
  m.action(msg::SIM_STOP);
  m.steps(kId);
  m.rate(0.1);
  m.at_step(kId);
}

inline void fill(msg::SimReply& m) {
  m.request_id(kId);
  m.accepted(true);
  m.step(kId);
  m.reason(std::string(200, 'r'));
}

inline void fill(msg::Rewind& m) {
  m.take(0xFFFF'FFFF);
  m.phase(msg::REWIND_CANCEL);
  m.at_step(kId);
}

inline void fill(msg::RewindAck& m) {
  m.take(0xFFFF'FFFF);
  m.phase(msg::REWIND_COMMIT);
  m.name(fullName());
}

inline void fill(msg::SimStatus& m) {
  m.state(msg::SIM_STATE_ABORTED);
  m.mode(msg::SIM_MODE_REALTIME);
  m.step(kId);
  m.time_ns(kTime);
  m.step_ns(kTime);
  m.take(7);
  m.first_step(kId);
  m.end_step(kId);
  m.rate(0.1);
  m.elapsed_s(1e9);
  m.holder(fullName());
  m.waiting_for(std::string(200, 'w'));
  m.reason(std::string(200, 'r'));
  m.missed_steps(kId);
  m.chain_hash(kId);
}

inline void fill(msg::TimeSpread& m) {
  m.count(kId);
  m.mean_us(0.1);
  m.p50_us(1.5);
  m.p99_us(2.5);
  m.p999_us(3.5);
  m.max_us(4.5);
}

inline void fill(msg::StepSpread& m) {
  m.count(kId);
  m.mean(0.1);
  m.p50(kId);
  m.p99(kId);
  m.p999(kId);
  m.max(kId);
}

inline void fill(msg::TimingStatus& m) {
  m.step(kId);
  fill(m.period());
  fill(m.jitter());
  fill(m.command_age());
  m.missed_steps(kId);
  fill(m.handover());
  m.last_handover_plan(kId);
  m.last_handover_us(5.5);
}

inline void fill(msg::SwapRequest& m) {
  m.request_id(kId);
  m.target(fullName());
  m.at_step(kId);
  m.force(true);
  m.dry_run(true);
  m.hard(true);
  m.blend_ns(kTime);
}

inline void fill(msg::SwapPlan& m) {
  m.plan_id(kId);
  m.phase(msg::SWAP_FORECAST);
  m.outgoing(fullName());
  m.incoming(fullName());
  m.forecast_step(kId);
  m.at_step(kId);
  m.blend_steps(kId);
  m.hard(true);
}

inline void fill(msg::SwapAck& m) {
  m.plan_id(kId);
  m.phase(msg::SWAP_COMMIT);
  m.controller(fullName());
  m.ready(true);
  m.effort(fullSequence());
  m.reason(std::string(200, 'r'));
}

inline void fill(msg::SwapOutcome& m) {
  m.request_id(kId);
  m.take(7);
  m.plan_id(kId);
  m.done(true);
  m.dry_run(true);
  m.feasible(true);
  m.hard(true);
  m.outgoing(fullName());
  m.incoming(fullName());
  m.decided_at_step(kId);
  m.forecast_step(kId);
  m.at_step(kId);
  m.blend_steps(kId);
  m.forecast_effort_step(fullSequence());
  m.raw_effort_step(fullSequence());
  m.applied_effort_step(fullSequence());
  m.reason(std::string(200, 'r'));
}

inline void fill(msg::SwapReport& m) {
  m.plan_id(kId);
  m.take(7);
  m.at_step(kId);
  m.steps(kId);
  m.cut_short(true);
  m.max_effort_rate(fullSequence());
  m.rate_limit_hits(kId);
  m.peak_force_deviation(0.5);
  m.blend_energy(-0.25);
}

inline void fill(msg::BatonMember& m) {
  m.name(fullName());
  m.failed(true);
  m.refused_at_step(kId);
  m.refusal(std::string(200, 'r'));
}

inline void fill(msg::BatonStatus& m) {
  m.holder(fullName());
  m.plan_id(kId);
  m.request_id(kId);
  m.incoming(fullName());
  m.at_step(kId);
  m.members().resize(msg::MAX_CONTROLLERS);
  for (msg::BatonMember& member : m.members()) fill(member);
}

inline void fill(msg::ControllerStatus& m) {
  m.name(fullName());
  m.law(fullName());
  m.uses_force(true);
  m.state(msg::CONTROLLER_FAILED);
  m.step(kId);
  m.effort(fullSequence());
  m.effort_gap(fullSequence());
  m.text(std::string(200, 't'));
}

inline void fill(msg::Parameter& m) {
  m.name(fullName());
  m.unit(fullName());
  m.doc(std::string(120, 'd'));
  m.numbers(fullSequence());
  m.minimum(-1e300);
  m.maximum(1e300);
  m.word(fullName());
  m.choices().resize(msg::MAX_WORDS, fullName());
}

inline void fill(msg::ParameterStatus& m) {
  m.name(fullName());
  m.law(fullName());
  m.parameters().resize(msg::MAX_PARAMETERS);
  for (msg::Parameter& parameter : m.parameters()) fill(parameter);
}

inline void fill(msg::ParameterValue& m) {
  m.name(fullName());
  m.numbers(fullSequence());
  m.word(fullName());
}

inline void fill(msg::ParameterRequest& m) {
  m.request_id(kId);
  m.controller(fullName());
  m.at_step(kId);
  m.values().resize(msg::MAX_PARAMETERS);
  for (msg::ParameterValue& value : m.values()) fill(value);
}

inline void fill(msg::ParameterReply& m) {
  m.request_id(kId);
  m.controller(fullName());
  m.accepted(true);
  m.at_step(kId);
  m.reason(std::string(400, 'r'));
}

inline void fill(msg::Decision& m) {
  m.step(kId);
  m.take(7);
  m.cause(msg::DECISION_END);
  m.controller(fullName());
  m.at_step(kId);
  m.force(true);
  m.hard(true);
  m.blend_steps(kId);
  m.commanded(true);
  m.restarted(true);
  m.values().resize(msg::MAX_PARAMETERS);
  for (msg::ParameterValue& value : m.values()) fill(value);
  m.reason(std::string(200, 'r'));
}

inline void fill(msg::LaunchRequest& m) {
  m.request_id(kId);
  m.action(msg::LAUNCH_STOP);
  m.name(fullName());
  m.law(std::string(64, 'l'));
  m.parameters(std::string(2000, 'p'));
}

inline void fill(msg::LaunchReply& m) {
  m.request_id(kId);
  m.accepted(true);
  m.pid(-2'000'000'000);
  m.reason(std::string(400, 'r'));
}

inline void fill(msg::ServiceStatus& m) {
  m.name(fullName());
  m.role(fullName());
  m.state(msg::SERVICE_FAILED);
  m.pid(-2'000'000'000);
  m.text(std::string(200, 't'));
  m.refused_topic(std::string(64, 'r'));
  m.refused_step(kId);
  m.refusal(std::string(120, 'w'));
}

inline void fill(msg::Event& m) {
  m.step(kId);
  m.time_ns(kTime);
  m.severity(msg::SEVERITY_ERROR);
  m.service(fullName());
  m.kind(fullName());
  m.text(std::string(400, 't'));
}

inline void fill(msg::StreamManifest& m) {
  m.topic(std::string(64, 't'));
  m.writer().fill(0xAB);
  m.first_sequence(kId);
  m.last_sequence(kId);
  m.count(kId);
  m.stream_hash(kId);
}

inline void fill(msg::ServiceManifest& m) {
  m.name(fullName());
  m.streams().resize(msg::MAX_STREAMS);
  for (msg::StreamManifest& stream : m.streams()) fill(stream);
}

inline void fill(msg::WriterLoss& m) {
  m.topic(std::string(64, 't'));
  m.service(fullName());
  m.lost(kId);
}

inline void fill(msg::RecordRequest& m) {
  m.request_id(kId);
  m.action(msg::RECORD_SNAPSHOT);
  m.path(std::string(400, 'p'));
}

inline void fill(msg::RecordReply& m) {
  m.request_id(kId);
  m.accepted(true);
  m.state(msg::RECORDER_FAILED);
  m.step(kId);
  m.path(std::string(400, 'p'));
  m.text(std::string(400, 't'));
}

inline void fill(msg::RecorderStatus& m) {
  m.state(msg::RECORDER_FAILED);
  m.ring(true);
  m.take(7);
  m.acknowledged_step(kId);
  m.messages(kId);
  m.bytes(kId);
  m.part(7);
  m.queued(kId);
  m.queued_bytes(kId);
  m.disk_left(kId);
  m.lost(kId);
  m.losses().resize(msg::MAX_LOSSES);
  for (msg::WriterLoss& loss : m.losses()) fill(loss);
  m.complete(true);
  m.path(std::string(400, 'p'));
  m.text(std::string(200, 't'));
}

inline void fill(msg::ReplayStatus& m) {
  m.state(msg::REPLAY_FINISHED);
  m.messages(kId);
  m.total(kId);
  m.pass(2);
  m.passes(3);
  m.rate(0.5);
  m.position_ns(kTime);
  m.duration_ns(kTime);
  m.lateness_p50_us(1.5);
  m.lateness_p99_us(2.5);
  m.lateness_max_us(3.5);
  m.overdue(kId);
  m.waiting_for(std::string(200, 'w'));
  m.path(std::string(400, 'p'));
}

inline void fill(msg::ReplayRequest& m) {
  m.request_id(kId);
  m.action(msg::REPLAY_STOP);
  m.messages(kId);
  m.topic(std::string(200, 't'));
  m.position_ns(kTime);
  m.rate(0.5);
}

inline void fill(msg::ReplayReply& m) {
  m.request_id(kId);
  m.accepted(true);
  m.messages(kId);
  m.position_ns(kTime);
  m.reason(std::string(200, 'r'));
}

template <class T>
T full() {
  T message;
  fill(message);
  return message;
}

}  // namespace baton::test
