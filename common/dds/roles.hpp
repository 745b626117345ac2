/// What the processes of a run are to each other.
#pragma once

#include <cstddef>
#include <cstdint>

namespace baton::dds {

enum class Role : std::uint8_t {
  kPlant,
  kEnvironment,
  kTrajectory,
  kController,
  kRecorder,
  kReplayer,
  kSupervisor,
  kOperator  // a command that watches or asks
};
inline constexpr std::size_t kRoles = 8;

/// Whose words count on a topic. The supervisor's do everywhere: it speaks for services that have died.
enum class WrittenBy {
  kPlant,
  kEnvironment,
  kTrajectory,
  kControllers,
  kRecorder,
  kReplayer,
  kSupervisor,
  kServices,  // any role but an operator
  kOperators  // anybody
};

[[nodiscard]] constexpr bool mayWrite(WrittenBy who, Role role) {
  if (role == Role::kSupervisor) return true;
  switch (who) {
    case WrittenBy::kPlant: return role == Role::kPlant;
    case WrittenBy::kEnvironment: return role == Role::kEnvironment;
    case WrittenBy::kTrajectory: return role == Role::kTrajectory;
    case WrittenBy::kControllers: return role == Role::kController;
    case WrittenBy::kRecorder: return role == Role::kRecorder;
    case WrittenBy::kReplayer: return role == Role::kReplayer;
    case WrittenBy::kSupervisor: return false;
    case WrittenBy::kServices: return role != Role::kOperator;
    case WrittenBy::kOperators: return true;
  }
  return false;
}

}  // namespace baton::dds
