#include "support/attacks.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace baton::test {
namespace {

constexpr bool kAsks = true, kSays = false;  // what operators say, or others
constexpr bool kIsInVain = false;            // it bites nobody, also with the key

template <class Topic, class Fill>
auto saying(const Topic& topic, const Fill& fill) {
  return [topic, fill](Stranger& stranger, const msg::PlantState& state, const LiveRun& run) {
    const auto message = fill(state, run);
    stranger.say(topic, message);
  };
}

msg::Contact contactAt(std::uint64_t step, double force) {
  msg::Contact contact;
  contact.step(step);
  contact.force({0.0, 0.0, force});
  contact.penetration(1.0);
  return contact;
}

msg::ServiceStatus statusOf(const std::string& name, const std::string& role, msg::ServiceState state, int pid) {
  msg::ServiceStatus status;
  status.name(name);
  status.role(role);
  status.state(state);
  status.pid(pid);
  status.text("said a stranger");
  return status;
}

msg::SimRequest simRequest(msg::SimAction action) {
  msg::SimRequest request;
  request.request_id(1);
  request.action(action);
  return request;
}

/// As the type makes it; where it has a step, of the next one.
template <class T>
T timely(const dds::Topic<T>& /*topic*/, const msg::PlantState& state) {
  T message;
  if constexpr (requires { message.step(std::uint64_t{}); }) message.step(state.step() + 1);
  return message;
}

using State = const msg::PlantState&;
using Run = const LiveRun&;

const Attack kAttacks[] = {
    {"contact", "environment",
     saying(dds::topics::kContact, [](State state, Run) { return contactAt(state.step(), 50.0); })},
    {"contact_ahead", "environment",
     saying(dds::topics::kContact, [](State state, Run) { return contactAt(state.step() + 1, 50.0); })},
    {"contact_nan", "environment",
     saying(dds::topics::kContact,
            [](State state, Run) { return contactAt(state.step() + 1, std::numeric_limits<double>::quiet_NaN()); })},
    {"contact_and_manifest", "friend",
     [](Stranger& stranger, State state, Run) {
       stranger.say(dds::topics::kContact, contactAt(state.step() + 1, 50.0));
       msg::ServiceManifest manifest;
       manifest.name("friend");
       stranger.say(dds::topics::kServiceManifest, manifest);
     }},
    {"reference", "trajectory",
     saying(dds::topics::kReference,
            [](State state, Run) {
              msg::Reference reference;
              reference.step(state.step() + 2);
              reference.position({1.0, 1.0, 1.0});
              return reference;
            })},
    {"plant_state", "plant",
     saying(dds::topics::kPlantState,
            [](State state, Run) {
              msg::PlantState forged = state;
              forged.step(state.step() + 1);
              forged.position({1.0, 1.0, 1.0});
              return forged;
            })},
    {"joint_command", "tracking",
     saying(dds::topics::kJointCommand,
            [](State state, Run) {
              msg::JointCommand command;
              command.step(state.step());
              command.controller(state.holder());
              command.effort({10.0, 10.0, 10.0});
              return command;
            })},
    {"takeover", "tracking",
     [](Stranger& stranger, State state, Run run) {
       const std::string holder = state.holder().c_str();
       msg::ServiceStatus ready = statusOf(holder, "controller", msg::SERVICE_READY, 1);
       stranger.say(dds::topics::kServiceStatus, ready);
       stranger.say(dds::topics::kServiceStatus,
                    statusOf(holder, "controller", msg::SERVICE_FAILED, holder.empty() ? 0 : run.pidOf(holder)));
       msg::ControllerStatus standby;
       standby.name(holder);
       standby.state(msg::CONTROLLER_STANDBY);
       standby.step(state.step());
       stranger.say(dds::topics::kControllerStatus, standby);
       msg::SwapRequest swap;
       swap.request_id(777);
       swap.target("pd");
       swap.force(true);
       stranger.say(dds::topics::kSwapRequest, swap);
       msg::JointCommand command;
       command.step(state.step());
       command.controller(holder);
       command.effort({10.0, 10.0, 10.0});
       stranger.say(dds::topics::kJointCommand, command);
     },
     kWritesOn, kAsks},
    {"environment_failed", "environment",
     saying(dds::topics::kServiceStatus,
            [](State, Run run) {
              return statusOf("environment", "environment", msg::SERVICE_FAILED, run.pidOf("environment"));
            })},
    {"plant_failed", "supervisor",
     saying(dds::topics::kServiceStatus,
            [](State, Run run) { return statusOf("plant", "plant", msg::SERVICE_FAILED, run.pidOf("plant")); })},
    {"another_plant", "trajectory",
     saying(dds::topics::kServiceStatus,
            [](State, Run run) {
              msg::ServiceStatus ready =
                  statusOf("trajectory", "trajectory", msg::SERVICE_READY, run.pidOf("trajectory"));
              ready.plant({1, 2, 3});
              return ready;
            }),
     kWritesOn, kSays, kIsInVain},
    {"finished", "plant",
     saying(dds::topics::kSimStatus,
            [](State state, Run) {
              msg::SimStatus status;
              status.state(msg::SIM_STATE_FINISHED);
              status.step(state.step());
              return status;
            }),
     kWritesOn, kSays, kIsInVain},
    {"aborted", "plant",
     saying(dds::topics::kSimStatus,
            [](State state, Run) {
              msg::SimStatus status;
              status.state(msg::SIM_STATE_ABORTED);
              status.step(state.step());
              return status;
            }),
     kWritesOn, kSays, kIsInVain},
    {"rewind", "plant",
     saying(dds::topics::kRewind,
            [](State state, Run) {
              msg::Rewind rewind;
              rewind.take(1);
              rewind.phase(msg::REWIND_COMMIT);
              rewind.at_step(state.step());
              return rewind;
            })},
    {"rewind_ack", "pd",
     saying(dds::topics::kRewindAck,
            [](State, Run) {
              msg::RewindAck ack;
              ack.take(1);
              ack.phase(msg::REWIND_COMMIT);
              ack.name("pd");
              return ack;
            }),
     kWritesOn, kSays, kIsInVain},
    {"recorder_status", "recorder",
     saying(dds::topics::kRecorderStatus,
            [](State state, Run) {
              msg::RecorderStatus status;
              status.state(msg::RECORDER_FAILED);
              status.acknowledged_step(state.step() + 1000);
              return status;
            }),
     kWritesOn, kSays, kIsInVain},
    {"swap_plan", "plant",
     saying(dds::topics::kSwapPlan,
            [](State state, Run) {
              msg::SwapPlan plan;
              plan.plan_id(99);
              plan.phase(msg::SWAP_COMMIT);
              plan.outgoing(state.holder());
              plan.incoming("pd");
              plan.at_step(state.step() + 1);
              plan.hard(true);
              return plan;
            })},
    {"swap_ack", "impedance",
     saying(dds::topics::kSwapAck,
            [](State, Run) {
              msg::SwapAck ack;
              ack.plan_id(1);
              ack.phase(msg::SWAP_PREPARE);
              ack.controller("impedance");
              ack.ready(false);
              return ack;
            })},
    {"swap_request", "operator-1",
     saying(dds::topics::kSwapRequest,
            [](State state, Run) {
              msg::SwapRequest request;
              request.request_id(state.step() + 1);
              request.target("pd");
              request.force(true);
              return request;
            }),
     kWritesOn, kAsks},
    {"sim_stop", "operator-1", saying(dds::topics::kSimRequest, [](State, Run) { return simRequest(msg::SIM_STOP); }),
     kWritesOn, kAsks},
    {"sim_pause", "supervisor", saying(dds::topics::kSimRequest, [](State, Run) { return simRequest(msg::SIM_PAUSE); }),
     kWritesOn, kAsks},
    {"sim_reset", "operator-1", saying(dds::topics::kSimRequest, [](State, Run) { return simRequest(msg::SIM_RESET); }),
     kWritesOn, kAsks},
    {"launch_stop", "operator-1",
     saying(dds::topics::kLaunchRequest,
            [](State, Run) {
              msg::LaunchRequest request;
              request.request_id(1);
              request.action(msg::LAUNCH_STOP);
              request.name("pd");
              return request;
            }),
     kWritesOn, kAsks},
    {"parameters", "operator-1",
     saying(dds::topics::kParameterRequest,
            [](State state, Run) {
              msg::ParameterRequest request;
              request.request_id(state.step() + 1);
              request.controller("impedance");
              msg::ParameterValue stiffer;
              stiffer.name("kp");
              stiffer.numbers({500.0});
              request.values({stiffer});
              return request;
            }),
     kWritesOn, kAsks},
    {"record_start", "operator-1",
     saying(dds::topics::kRecordRequest,
            [](State, Run run) {
              msg::RecordRequest request;
              request.request_id(1);
              request.action(msg::RECORD_START);
              request.path((run.bench.folder() / "authorized_keys").string());
              return request;
            }),
     kWritesOn, kAsks, kIsInVain},
    {"record_stop", "operator-1",
     saying(dds::topics::kRecordRequest,
            [](State, Run) {
              msg::RecordRequest request;
              request.request_id(1);
              request.action(msg::RECORD_STOP);
              return request;
            }),
     kWritesOn, kAsks},
    {"manifest", "environment",
     saying(dds::topics::kServiceManifest,
            [](State, Run) {
              msg::ServiceManifest manifest;
              manifest.name("environment");
              return manifest;
            }),
     kWritesOn, kSays, kIsInVain},
    {"event", "plant",
     saying(dds::topics::kEvent,
            [](State, Run) {
              msg::Event event;
              event.severity(msg::SEVERITY_ERROR);
              event.service("plant");
              event.kind("failover");
              return event;
            })},
    {"every_topic", "meter",
     [](Stranger& stranger, State state, Run) {
       dds::topics::forEach([&](const auto& topic) { stranger.say(topic, timely(topic, state)); });
     },
     kWritesOn, kAsks},
    {"contact_flood", "environment",
     [](Stranger& stranger, State state, Run) {
       for (int i = 0; i < 5; ++i) stranger.say(dds::topics::kContact, contactAt(state.step() + 1, 50.0));
     }},
    {"another_type", "gauge",
     [](Stranger& stranger, State, Run) { stranger.sayRaw("contact", "somebody::Else", std::array<std::byte, 8>{}); },
     kWritesOn, kSays, kIsInVain},
    {"control_characters", "beacon",
     [](Stranger& stranger, State, Run) {
       stranger.sayRaw("\nssh-ed25519 AAAA\n", "somebody::Else", std::array<std::byte, 8>{});
     },
     "control characters in the name", kSays, kIsInVain},
    {"truncated", "tracking",
     [](Stranger& stranger, State, Run) {
       stranger.sayBytes(dds::topics::kJointCommand, std::array{std::byte{0}, std::byte{1}, std::byte{0}});
     }},
    {"garbage", "trajectory",
     [](Stranger& stranger, State state, Run) {
       std::mt19937_64 random(state.step());
       std::vector<std::byte> payload(random() % 500);
       for (std::byte& one : payload) one = static_cast<std::byte>(random());
       stranger.sayBytes(dds::topics::kReference, payload);
     }},
    {"huge", "tracking",
     [](Stranger& stranger, State state, Run) {
       if (state.step() % 200 == 0) stranger.sayBytes(dds::topics::kJointCommand, std::vector<std::byte>(4 << 20));
     }},
    {"from_the_future", "tracking",
     [](Stranger& stranger, State state, Run) {
       constexpr std::int64_t kIn2060_ns = 2'840'000'000'000'000'000;
       msg::JointCommand command;
       command.step(state.step());
       std::vector<std::byte> room(dds::maxPayload<msg::JointCommand>());
       stranger.sayBytes(dds::topics::kJointCommand, dds::encode(command, std::span(room)), kIn2060_ns);
     }},
    {"exclusive", "environment",
     [](Stranger& stranger, State, Run) {
       stranger.sayWith({.topic = "contact",
                         .type = dds::topics::kContact.type,
                         .exclusive_ownership = true,
                         .ownership_strength = 4'000'000'000U},
                        std::array<std::byte, 8>{});
     }},
    {"keyed", "environment",
     [](Stranger& stranger, State, Run) {
       stranger.sayWith({.topic = "contact", .type = dds::topics::kContact.type, .keyed = true},
                        std::array<std::byte, 8>{});
     }},
    {"refusing_readers", "viewer",
     [](Stranger& stranger, State, Run) { stranger.aside([&] { stranger.refuseAll(dds::topics::kPlantState, 50); }); },
     "calls itself viewer", kSays, kIsInVain},
    {"user_data", "chatterbox",
     [](Stranger& stranger, State, Run) { stranger.aside([&] { stranger.participant().announce(); }); },
     "calls itself chatterbox", kSays, kIsInVain},
    {"flood_of_its_own", "camera",
     [](Stranger& stranger, State, Run) {
       stranger.sayRaw("their_picture", "somebody::Picture", std::vector<std::byte>(60'000));
     },
     "calls itself camera", kSays, kIsInVain},
};

}  // namespace

std::span<const Attack> attacks() { return kAttacks; }

}  // namespace baton::test
