/// The law and the values that held the baton give the recorded torque again, bit for bit.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "msg/loop.h"
#include "support/processes.hpp"
#include "support/recordings.hpp"

namespace baton::test {

/// Of every controller that held the baton in a recording, or in the last take of one. Returns how many there were.
inline int expectReproduced(const Bench& bench, const std::string& recording) {
  std::map<std::string, int> held;  // steps; of a run that was reset, of all takes
  for (const auto& state : decodeStream<msg::PlantState>(readStreams(recording)[{"plant_state", "plant"}])) {
    ++held[state.holder().c_str()];
  }
  held.erase("");
  int reproduced = 0;
  for (const auto& [name, steps] : held) {
    const nlohmann::json made = bench.batonJson({"whatif", recording, "--as", name, "--json"});
    const bool was_there = made.at("difference").at("steps") > 0;
    if (!was_there) continue;
    EXPECT_TRUE(made.at("exact")) << name << " of " << recording << ": " << made.at("difference");
    EXPECT_EQ(made.at("with_other_inputs").at("steps"), 0) << name;
    EXPECT_LE(made.at("difference").at("steps"), steps);
    ++reproduced;
  }
  EXPECT_GT(reproduced, 0) << recording;
  return reproduced;
}

}  // namespace baton::test
