/// The named QoS profiles as Fast DDS structures. Private to common/dds.
#pragma once

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "dds/types.hpp"

namespace baton::dds {

void applyProfile(Profile profile, eprosima::fastdds::dds::DataWriterQos& qos);
void applyProfile(Profile profile, eprosima::fastdds::dds::DataReaderQos& qos);

}  // namespace baton::dds
