#include "dds/qos.hpp"

#include <algorithm>

#include "dds/history.hpp"

namespace baton::dds {
namespace {
using namespace fastdds::dds;

struct ProfileValues {
  DurabilityQosPolicyKind durability;
  int writer_depth;
  int reader_depth;
};

/// All profiles are reliable and KEEP_LAST, so that write() never blocks.
ProfileValues valuesOf(Profile profile) {
  switch (profile) {
    case Profile::kLoop:
      // The writer keeps more steps than the plant may run past the recorder (credit_steps, at most 512), so a recorder
      // that was held up still gets every one of them. The reader's depth is the same: what arrives behind a lost
      // datagram waits there for the repair.
      return {VOLATILE_DURABILITY_QOS, 1024, 1024};
    case Profile::kRequest:
      // Writer and reader see their match at different times; a request sent in between is kept for the reader. Whoever
      // asks leaves soon after, and the request with it.
      return {TRANSIENT_LOCAL_DURABILITY_QOS, 32, 32};
    case Profile::kStatus:
      // One writer a service, many services a topic: the reader's depth holds the last word of each.
      return {TRANSIENT_LOCAL_DURABILITY_QOS, 1, 64};
    case Profile::kEvent: return {TRANSIENT_LOCAL_DURABILITY_QOS, 1024, 1024};
  }
  return {VOLATILE_DURABILITY_QOS, 1, 1};
}

template <class Qos>
void applyCommon(Profile profile, int depth, Qos& qos) {
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = valuesOf(profile).durability;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  qos.resource_limits().max_samples = depth + 1;
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = depth + 1;
  // To begin with; a history grows. A reader's is emptied with every sample, and 64 in each would be 2 MB of a
  // recorder.
  qos.resource_limits().allocated_samples = std::min(depth, 8);
  // Its default lets a reader that is killed abort the writer's process.
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = fastdds::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}
}  // namespace

std::size_t latchedDepth(Profile profile) {
  const ProfileValues values = valuesOf(profile);
  return values.durability == VOLATILE_DURABILITY_QOS ? 0 : static_cast<std::size_t>(values.writer_depth);
}

void applyProfile(Profile profile, DataWriterQos& qos) {
  applyCommon(profile, valuesOf(profile).writer_depth, qos);
  qos.publish_mode().kind = SYNCHRONOUS_PUBLISH_MODE;
  // A lost datagram is noticed within one heartbeat; the default of 3 s would stall a lockstep loop that long.
  const auto times = fastdds::timesOf(qos);
  times.heartbeat_period = {0, 20'000'000};
  times.nack_response_delay = {0, 0};
  // How long what was just sent may still be on its way, and asking for it again goes unheard. With the default of 0 a
  // timer runs out behind every sample to every reader: a thread is woken each time, which costs a third of a step.
  times.nack_suppression_duration = {0, 10'000'000};
  // Otherwise every sample behind a full history, which is every one from step 1024 on, carries a heartbeat to every
  // reader, each of which answers it.
  qos.reliable_writer_qos().disable_heartbeat_piggyback = true;
}

void applyProfile(Profile profile, DataReaderQos& qos) {
  applyCommon(profile, valuesOf(profile).reader_depth, qos);
  const auto times = fastdds::timesOf(qos);
  times.initial_acknack_delay = {0, 5'000'000};
  times.heartbeat_response_delay = {0, 1'000'000};
}

}  // namespace baton::dds
