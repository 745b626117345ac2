/// Every topic of Baton, one line each. A topic is one struct in idl/ and one line here; recorder and replayer need
/// none.
#pragma once

#include <string_view>

#include "dds/types.hpp"
#include "msg/checkpoint.h"
#include "msg/decision.h"
#include "msg/loop.h"
#include "msg/parameter.h"
#include "msg/record.h"
#include "msg/service.h"
#include "msg/sim.h"
#include "msg/swap.h"

namespace baton::dds {

/// Topics of which a writer's latest word is all that counts are called so; of the others every sample matters.
[[nodiscard]] constexpr bool isStatusTopic(std::string_view name) { return name.ends_with("_status"); }

template <class T>
struct Topic {
  consteval Topic(const char* name_in, const char* type_in, Profile profile_in)
      : name(name_in), type(type_in), profile(profile_in) {
    if (isStatusTopic(name) != (profile == Profile::kStatus)) throw "a topic's name and its profile disagree";
  }
  const char* name;
  const char* type;
  Profile profile;
};

namespace topics {
// clang-format off
inline constexpr Topic<msg::PlantState>       kPlantState      {"plant_state",       "baton::msg::PlantState",       Profile::kLoop};
inline constexpr Topic<msg::PlantState>       kPlantStateAgain {"plant_state_again", "baton::msg::PlantState",       Profile::kLoop};
inline constexpr Topic<msg::Contact>          kContact         {"contact",           "baton::msg::Contact",          Profile::kLoop};
inline constexpr Topic<msg::Reference>        kReference       {"reference",         "baton::msg::Reference",        Profile::kLoop};
inline constexpr Topic<msg::JointCommand>     kJointCommand    {"joint_command",     "baton::msg::JointCommand",     Profile::kLoop};
inline constexpr Topic<msg::JointCommand>     kShadowCommand   {"shadow_command",    "baton::msg::JointCommand",     Profile::kLoop};
inline constexpr Topic<msg::Checkpoint>       kCheckpoint      {"checkpoint",        "baton::msg::Checkpoint",       Profile::kLoop};
inline constexpr Topic<msg::SimRequest>       kSimRequest      {"sim_request",       "baton::msg::SimRequest",       Profile::kRequest};
inline constexpr Topic<msg::SimReply>         kSimReply        {"sim_reply",         "baton::msg::SimReply",         Profile::kRequest};
inline constexpr Topic<msg::SimStatus>        kSimStatus       {"sim_status",        "baton::msg::SimStatus",        Profile::kStatus};
inline constexpr Topic<msg::Rewind>           kRewind          {"rewind",            "baton::msg::Rewind",           Profile::kLoop};
inline constexpr Topic<msg::RewindAck>        kRewindAck       {"rewind_ack",        "baton::msg::RewindAck",        Profile::kLoop};
inline constexpr Topic<msg::TimingStatus>     kTimingStatus    {"timing_status",     "baton::msg::TimingStatus",     Profile::kStatus};
inline constexpr Topic<msg::SwapRequest>      kSwapRequest     {"swap_request",      "baton::msg::SwapRequest",      Profile::kRequest};
inline constexpr Topic<msg::SwapPlan>         kSwapPlan        {"swap_plan",         "baton::msg::SwapPlan",         Profile::kEvent};
inline constexpr Topic<msg::SwapAck>          kSwapAck         {"swap_ack",          "baton::msg::SwapAck",          Profile::kEvent};
inline constexpr Topic<msg::SwapOutcome>      kSwapOutcome     {"swap_outcome",      "baton::msg::SwapOutcome",      Profile::kEvent};
inline constexpr Topic<msg::SwapReport>       kSwapReport      {"swap_report",       "baton::msg::SwapReport",       Profile::kEvent};
inline constexpr Topic<msg::BatonStatus>      kBatonStatus     {"baton_status",      "baton::msg::BatonStatus",      Profile::kStatus};
inline constexpr Topic<msg::ControllerStatus> kControllerStatus{"controller_status", "baton::msg::ControllerStatus", Profile::kStatus};
inline constexpr Topic<msg::ParameterStatus>  kParameterStatus {"parameter_status",  "baton::msg::ParameterStatus",  Profile::kStatus};
inline constexpr Topic<msg::ParameterRequest> kParameterRequest{"parameter_request", "baton::msg::ParameterRequest", Profile::kRequest};
inline constexpr Topic<msg::ParameterReply>   kParameterReply  {"parameter_reply",   "baton::msg::ParameterReply",   Profile::kEvent};
inline constexpr Topic<msg::Decision>         kDecision        {"decision",          "baton::msg::Decision",         Profile::kEvent};
inline constexpr Topic<msg::LaunchRequest>    kLaunchRequest   {"launch_request",    "baton::msg::LaunchRequest",    Profile::kRequest};
inline constexpr Topic<msg::LaunchReply>      kLaunchReply     {"launch_reply",      "baton::msg::LaunchReply",      Profile::kEvent};
inline constexpr Topic<msg::ServiceStatus>    kServiceStatus   {"service_status",    "baton::msg::ServiceStatus",    Profile::kStatus};
inline constexpr Topic<msg::ServiceManifest>  kServiceManifest {"service_manifest",  "baton::msg::ServiceManifest",  Profile::kEvent};
inline constexpr Topic<msg::Event>            kEvent           {"event",             "baton::msg::Event",            Profile::kEvent};
inline constexpr Topic<msg::RecorderStatus>   kRecorderStatus  {"recorder_status",   "baton::msg::RecorderStatus",   Profile::kStatus};
inline constexpr Topic<msg::RecordRequest>    kRecordRequest   {"record_request",    "baton::msg::RecordRequest",    Profile::kRequest};
inline constexpr Topic<msg::RecordReply>      kRecordReply     {"record_reply",      "baton::msg::RecordReply",      Profile::kRequest};
inline constexpr Topic<msg::ReplayStatus>     kReplayStatus    {"replay_status",     "baton::msg::ReplayStatus",     Profile::kStatus};
inline constexpr Topic<msg::ReplayRequest>    kReplayRequest   {"replay_request",    "baton::msg::ReplayRequest",    Profile::kRequest};
inline constexpr Topic<msg::ReplayReply>      kReplayReply     {"replay_reply",      "baton::msg::ReplayReply",      Profile::kRequest};
// clang-format on
}  // namespace topics

}  // namespace baton::dds
