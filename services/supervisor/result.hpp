/// How a run went, as result.json in its folder: what `baton run` and `baton down` tell from, and scripts read.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "msg/record.h"
#include "msg/sim.h"
#include "msg/swap.h"
#include "runtime/cell.hpp"
#include "runtime/scenario.hpp"

namespace baton {

struct RunResult {
  ExitCode exit_code = ExitCode::kOk;
  std::string reason;            // empty when all went well
  double startup_s = -1.0;       // from the launch of the first process to step 0; negative: never started
  msg::SimStatus sim;            // the plant's last word
  msg::TimingStatus timing;      // likewise
  msg::RecorderStatus recorder;  // the recorder's last word
  std::vector<msg::SwapOutcome> swaps;
  std::vector<msg::SwapReport> reports;     // on those that were done
  std::map<std::string, long> resident_kB;  // by service, when the run ended
};

/// Writes the file whole or not at all. Throws UnavailableError when it cannot.
void writeResult(const RunInfo& info, const Scenario& scenario, const RunResult& result);

}  // namespace baton
