/// Every topic of Baton, one line each. A topic is one struct in idl/, one line here and one row in idl/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "dds/roles.hpp"
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

/// Whose samples a recording must have from the first one on, or it is not complete. A run begins when the recorder
/// reads them. Samples of other writers are recorded from when the writer is discovered, unless the writer itself waits
/// for the recorder, as controllers do with `checkpoint` and `decision`.
enum class RecordedFrom { kNobody, kPlant, kTrajectory, kEnvironment, kControllers, kServices };

struct TopicFacts {
  const char* name;
  const char* type;
  Profile profile;
  WrittenBy written_by;
  RecordedFrom recorded_from;
};

/// The facts of a topic whose samples are of type T.
template <class T>
struct Topic : TopicFacts {};

// TOPIC(constant, name, type, profile, written by, recorded from the first sample on)
// clang-format off
#define BATON_TOPICS(TOPIC) \
  TOPIC(kPlantState,       "plant_state",        PlantState,       kLoop,    kPlant,       kPlant)       \
  TOPIC(kPlantStateAgain,  "plant_state_again",  PlantState,       kLoop,    kPlant,       kNobody)      \
  TOPIC(kContact,          "contact",            Contact,          kLoop,    kEnvironment, kEnvironment) \
  TOPIC(kReference,        "reference",          Reference,        kLoop,    kTrajectory,  kTrajectory)  \
  TOPIC(kJointCommand,     "joint_command",      JointCommand,     kLoop,    kControllers, kControllers) \
  TOPIC(kShadowCommand,    "shadow_command",     JointCommand,     kLoop,    kControllers, kControllers) \
  TOPIC(kCheckpoint,       "checkpoint",         Checkpoint,       kLoop,    kServices,    kPlant)       \
  TOPIC(kSimRequest,       "sim_request",        SimRequest,       kRequest, kOperators,   kNobody)      \
  TOPIC(kSimReply,         "sim_reply",          SimReply,         kRequest, kPlant,       kNobody)      \
  TOPIC(kSimStatus,        "sim_status",         SimStatus,        kStatus,  kPlant,       kNobody)      \
  TOPIC(kRewind,           "rewind",             Rewind,           kLoop,    kPlant,       kPlant)       \
  TOPIC(kRewindAck,        "rewind_ack",         RewindAck,        kLoop,    kServices,    kNobody)      \
  TOPIC(kTimingStatus,     "timing_status",      TimingStatus,     kStatus,  kPlant,       kNobody)      \
  TOPIC(kSwapRequest,      "swap_request",       SwapRequest,      kRequest, kOperators,   kNobody)      \
  TOPIC(kSwapPlan,         "swap_plan",          SwapPlan,         kEvent,   kPlant,       kPlant)       \
  TOPIC(kSwapAck,          "swap_ack",           SwapAck,          kEvent,   kControllers, kControllers) \
  TOPIC(kSwapOutcome,      "swap_outcome",       SwapOutcome,      kEvent,   kPlant,       kPlant)       \
  TOPIC(kSwapReport,       "swap_report",        SwapReport,       kEvent,   kPlant,       kPlant)       \
  TOPIC(kBatonStatus,      "baton_status",       BatonStatus,      kStatus,  kPlant,       kNobody)      \
  TOPIC(kControllerStatus, "controller_status",  ControllerStatus, kStatus,  kControllers, kNobody)      \
  TOPIC(kParameterStatus,  "parameter_status",   ParameterStatus,  kStatus,  kControllers, kNobody)      \
  TOPIC(kParameterRequest, "parameter_request",  ParameterRequest, kRequest, kOperators,   kNobody)      \
  TOPIC(kParameterReply,   "parameter_reply",    ParameterReply,   kEvent,   kControllers, kNobody)      \
  TOPIC(kDecision,         "decision",           Decision,         kEvent,   kServices,    kPlant)       \
  TOPIC(kLaunchRequest,    "launch_request",     LaunchRequest,    kRequest, kOperators,   kNobody)      \
  TOPIC(kLaunchReply,      "launch_reply",       LaunchReply,      kEvent,   kSupervisor,  kNobody)      \
  TOPIC(kServiceStatus,    "service_status",     ServiceStatus,    kStatus,  kServices,    kNobody)      \
  TOPIC(kServiceManifest,  "service_manifest",   ServiceManifest,  kEvent,   kServices,    kServices)    \
  TOPIC(kEvent,            "event",              Event,            kEvent,   kServices,    kServices)    \
  TOPIC(kRecorderStatus,   "recorder_status",    RecorderStatus,   kStatus,  kRecorder,    kNobody)      \
  TOPIC(kRecordRequest,    "record_request",     RecordRequest,    kRequest, kOperators,   kNobody)      \
  TOPIC(kRecordReply,      "record_reply",       RecordReply,      kRequest, kRecorder,    kNobody)      \
  TOPIC(kReplayStatus,     "replay_status",      ReplayStatus,     kStatus,  kReplayer,    kNobody)      \
  TOPIC(kReplayRequest,    "replay_request",     ReplayRequest,    kRequest, kOperators,   kNobody)      \
  TOPIC(kReplayReply,      "replay_reply",       ReplayReply,      kRequest, kReplayer,    kNobody)
// clang-format on

namespace topics {
#define BATON_TOPIC_CONSTANT(constant, name, type, profile, by, from) \
  inline constexpr Topic<msg::type> constant{                         \
      {name, "baton::msg::" #type, Profile::profile, WrittenBy::by, RecordedFrom::from}};
BATON_TOPICS(BATON_TOPIC_CONSTANT)
#undef BATON_TOPIC_CONSTANT

#define BATON_TOPIC_FACTS(constant, name, type, profile, by, from) static_cast<const TopicFacts&>(constant),
inline constexpr std::array kAll{BATON_TOPICS(BATON_TOPIC_FACTS)};
#undef BATON_TOPIC_FACTS

#define BATON_TOPIC_VISIT(constant, ...) visit(constant);
/// Calls `visit` with each topic, whose types differ.
template <class Visit>
constexpr void forEach(const Visit& visit) {
  BATON_TOPICS(BATON_TOPIC_VISIT)
}
#undef BATON_TOPIC_VISIT

/// Of a topic of Baton's; nullptr for any other.
[[nodiscard]] constexpr const TopicFacts* called(std::string_view name) {
  const auto found = std::ranges::find(kAll, name, &TopicFacts::name);
  return found == kAll.end() ? nullptr : &*found;
}

static_assert(std::ranges::all_of(kAll,
                                  [](const TopicFacts& topic) {
                                    return std::string_view(topic.name).ends_with("_status") ==
                                           (topic.profile == Profile::kStatus);
                                  }),
              "a topic with the profile kStatus is called ..._status, and no other is");
}  // namespace topics
#undef BATON_TOPICS

/// Whether a topic is none of Baton's.
[[nodiscard]] constexpr bool isForeignTopic(std::string_view name) { return topics::called(name) == nullptr; }

/// Whether a topic of Baton's carries states: only a writer's latest sample counts. Of the others, and of all topics of
/// other people whatever their names, every sample matters.
[[nodiscard]] constexpr bool isStatusTopic(std::string_view name) {
  const TopicFacts* facts = topics::called(name);
  return facts != nullptr && facts->profile == Profile::kStatus;
}

}  // namespace baton::dds
