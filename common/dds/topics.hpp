/// Every topic of Baton, one line each. A topic is one struct in idl/, one line here and one row in idl/README.md.
#pragma once

#include <algorithm>
#include <array>
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

/// A topic whose name ends so carries states: only a writer's latest sample counts. Of the others every sample matters.
[[nodiscard]] constexpr bool isStatusTopic(std::string_view name) { return name.ends_with("_status"); }

/// Whose samples a recording must have from the first one on, or it is not complete. A run begins when the recorder
/// reads them. Samples of other writers are recorded from when the writer is discovered, unless the writer itself waits
/// for the recorder, as controllers do with `checkpoint` and `decision`.
enum class RecordedFrom { kNobody, kPlant, kTrajectory, kEnvironment, kControllers, kServices };

struct TopicFacts {
  const char* name;
  const char* type;
  Profile profile;
  RecordedFrom recorded_from;
};

/// The facts of a topic whose samples are of type T.
template <class T>
struct Topic : TopicFacts {};

// TOPIC(constant, name, type, profile, recorded from the first sample on)
// clang-format off
#define BATON_TOPICS(TOPIC) \
  TOPIC(kPlantState,       "plant_state",        PlantState,       kLoop,    kPlant)       \
  TOPIC(kPlantStateAgain,  "plant_state_again",  PlantState,       kLoop,    kNobody)      \
  TOPIC(kContact,          "contact",            Contact,          kLoop,    kEnvironment) \
  TOPIC(kReference,        "reference",          Reference,        kLoop,    kTrajectory)  \
  TOPIC(kJointCommand,     "joint_command",      JointCommand,     kLoop,    kControllers) \
  TOPIC(kShadowCommand,    "shadow_command",     JointCommand,     kLoop,    kControllers) \
  TOPIC(kCheckpoint,       "checkpoint",         Checkpoint,       kLoop,    kPlant)       \
  TOPIC(kSimRequest,       "sim_request",        SimRequest,       kRequest, kNobody)      \
  TOPIC(kSimReply,         "sim_reply",          SimReply,         kRequest, kNobody)      \
  TOPIC(kSimStatus,        "sim_status",         SimStatus,        kStatus,  kNobody)      \
  TOPIC(kRewind,           "rewind",             Rewind,           kLoop,    kPlant)       \
  TOPIC(kRewindAck,        "rewind_ack",         RewindAck,        kLoop,    kNobody)      \
  TOPIC(kTimingStatus,     "timing_status",      TimingStatus,     kStatus,  kNobody)      \
  TOPIC(kSwapRequest,      "swap_request",       SwapRequest,      kRequest, kNobody)      \
  TOPIC(kSwapPlan,         "swap_plan",          SwapPlan,         kEvent,   kPlant)       \
  TOPIC(kSwapAck,          "swap_ack",           SwapAck,          kEvent,   kControllers) \
  TOPIC(kSwapOutcome,      "swap_outcome",       SwapOutcome,      kEvent,   kPlant)       \
  TOPIC(kSwapReport,       "swap_report",        SwapReport,       kEvent,   kPlant)       \
  TOPIC(kBatonStatus,      "baton_status",       BatonStatus,      kStatus,  kNobody)      \
  TOPIC(kControllerStatus, "controller_status",  ControllerStatus, kStatus,  kNobody)      \
  TOPIC(kParameterStatus,  "parameter_status",   ParameterStatus,  kStatus,  kNobody)      \
  TOPIC(kParameterRequest, "parameter_request",  ParameterRequest, kRequest, kNobody)      \
  TOPIC(kParameterReply,   "parameter_reply",    ParameterReply,   kEvent,   kNobody)      \
  TOPIC(kDecision,         "decision",           Decision,         kEvent,   kPlant)       \
  TOPIC(kLaunchRequest,    "launch_request",     LaunchRequest,    kRequest, kNobody)      \
  TOPIC(kLaunchReply,      "launch_reply",       LaunchReply,      kEvent,   kNobody)      \
  TOPIC(kServiceStatus,    "service_status",     ServiceStatus,    kStatus,  kNobody)      \
  TOPIC(kServiceManifest,  "service_manifest",   ServiceManifest,  kEvent,   kServices)    \
  TOPIC(kEvent,            "event",              Event,            kEvent,   kServices)    \
  TOPIC(kRecorderStatus,   "recorder_status",    RecorderStatus,   kStatus,  kNobody)      \
  TOPIC(kRecordRequest,    "record_request",     RecordRequest,    kRequest, kNobody)      \
  TOPIC(kRecordReply,      "record_reply",       RecordReply,      kRequest, kNobody)      \
  TOPIC(kReplayStatus,     "replay_status",      ReplayStatus,     kStatus,  kNobody)      \
  TOPIC(kReplayRequest,    "replay_request",     ReplayRequest,    kRequest, kNobody)      \
  TOPIC(kReplayReply,      "replay_reply",       ReplayReply,      kRequest, kNobody)
// clang-format on

namespace topics {
#define BATON_TOPIC_CONSTANT(constant, name, type, profile, from) \
  inline constexpr Topic<msg::type> constant{{name, "baton::msg::" #type, Profile::profile, RecordedFrom::from}};
BATON_TOPICS(BATON_TOPIC_CONSTANT)
#undef BATON_TOPIC_CONSTANT

#define BATON_TOPIC_FACTS(constant, name, type, profile, from) static_cast<const TopicFacts&>(constant),
inline constexpr std::array kAll{BATON_TOPICS(BATON_TOPIC_FACTS)};
#undef BATON_TOPIC_FACTS
static_assert(std::ranges::all_of(kAll,
                                  [](const TopicFacts& topic) {
                                    return isStatusTopic(topic.name) == (topic.profile == Profile::kStatus);
                                  }),
              "a topic with the profile kStatus is called ..._status, and no other is");
}  // namespace topics
#undef BATON_TOPICS

}  // namespace baton::dds
