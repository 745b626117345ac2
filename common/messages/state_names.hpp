/// The states of the status messages in words, as command lines print them.
#pragma once

#include "msg/record.h"
#include "msg/service.h"
#include "msg/sim.h"
#include "msg/swap.h"

namespace baton {

[[nodiscard]] const char* toString(msg::SimState state);
[[nodiscard]] const char* toString(msg::ControllerState state);
[[nodiscard]] const char* toString(msg::ServiceState state);
[[nodiscard]] const char* toString(msg::RecorderState state);
[[nodiscard]] const char* toString(msg::ReplayState state);

}  // namespace baton
