/// What of the traffic a run's recorder reads: all topics of its cell, whoever writes there. On the topics of the run
/// only those are recorded who are heard there. A topic that is left out is read only where the run waits for the
/// recorder to listen.
#pragma once

#include "discovery.hpp"
#include "runtime/service.hpp"

namespace baton {

[[nodiscard]] ReadingRules rulesOfRun(Service& service);

/// The run begins when the recorder reads the topics that it must have from the first sample on.
void requireRecorded(Service& service, const TopicReaders& readers);

}  // namespace baton
