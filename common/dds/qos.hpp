/// The named QoS profiles as Fast DDS structures. Private to common/dds.
#pragma once

#include "dds/fastdds.hpp"
#include "dds/types.hpp"

namespace baton::dds {

void applyProfile(Profile profile, fastdds::dds::DataWriterQos& qos);
void applyProfile(Profile profile, fastdds::dds::DataReaderQos& qos);

}  // namespace baton::dds
