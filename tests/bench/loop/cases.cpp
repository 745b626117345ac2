#include "cases.hpp"

#include "cells.hpp"
#include "scenario.hpp"

namespace baton::bench {
namespace {
using Json = nlohmann::ordered_json;

constexpr double kBytesPerKilobyte = 1024.0;

Measurement measureRaw(const Case& one, int steps, Programs& programs) {
  std::vector<std::string> arguments{"--hops",   std::to_string(one.hops()),
                                     "--domain", std::to_string(programs.domain()),
                                     "--steps",  std::to_string(steps)};
  if (one.shared_memory) arguments.emplace_back("--shm");
  if (one.recorded) arguments.emplace_back("--observed");
  const Json period = programs.run("baton-raw-chain", std::move(arguments)).at("period_us");
  return {.p50_us = period.at("p50"), .p99_us = period.at("p99"), .steps_per_s = 1e6 / period.at("mean").get<double>()};
}

Measurement measureRun(const Case& one, int steps, Programs& programs) {
  std::vector<std::string> arguments{
      "run",         programs.write("bench.yaml", scenarioText(one.uses_force, one.standbys, steps)),
      "--domain",    std::to_string(programs.domain()),
      "--transport", one.shared_memory ? "shm" : "udp",
      "--json"};
  if (one.kind == Case::Kind::kInProcess) {
    arguments.emplace_back("--in-process");
  } else if (!one.recorded) {
    arguments.emplace_back("--no-recording");
  }
  const Json result = programs.run("baton", std::move(arguments));
  const Json& period = result.at("timing").at("period_us");
  Measurement measured{.p50_us = period.at("p50"),
                       .p99_us = period.at("p99"),
                       .steps_per_s = 1e6 / period.at("mean").get<double>(),
                       .startup_s = result.at("startup_s")};
  if (one.kind == Case::Kind::kBaton) {
    for (const auto& [name, kilobytes] : result.at("resident_kB").items()) {
      measured.resident_MB[name] = kilobytes.get<double>() * kBytesPerKilobyte * 1e-6;
    }
  }
  return measured;
}

}  // namespace

int Case::processes() const {
  if (kind == Kind::kInProcess) return 1;
  const int in_a_cell = 4 + standbys + (recorded ? 1 : 0);
  return in_a_cell * cells;
}

const std::vector<Case>& allCases() {
  using Kind = Case::Kind;
  static const std::vector<Case> cases{
      {.name = "raw-3-hops", .kind = Kind::kRaw},
      {.name = "force"},
      {.name = "raw-2-hops", .kind = Kind::kRaw, .uses_force = false},
      {.name = "motion", .uses_force = false},
      {.name = "raw-3-hops-shm", .kind = Kind::kRaw, .shared_memory = true},
      {.name = "force-shm", .shared_memory = true},
      {.name = "raw-3-hops-observed", .kind = Kind::kRaw, .recorded = true},
      {.name = "force-recorded", .recorded = true},
      {.name = "motion-recorded", .uses_force = false, .recorded = true},
      {.name = "force-3-standby", .standbys = 3},
      {.name = "force-6-standby", .standbys = 6},
      {.name = "force-3-standby-recorded", .recorded = true, .standbys = 3},
      {.name = "in-process", .kind = Kind::kInProcess},
      {.name = "cells-1", .kind = Kind::kCells},
      {.name = "cells-2", .kind = Kind::kCells, .cells = 2},
      {.name = "cells-4", .kind = Kind::kCells, .cells = 4},
      {.name = "cells-8", .kind = Kind::kCells, .cells = 8},
  };
  return cases;
}

Measurement measure(const Case& one, int steps, Programs& programs) {
  switch (one.kind) {
    case Case::Kind::kRaw: return measureRaw(one, steps, programs);
    case Case::Kind::kCells: return measureCells(one, steps, programs);
    case Case::Kind::kBaton:
    case Case::Kind::kInProcess: break;
  }
  return measureRun(one, steps, programs);
}

bool canRunInProcess(Programs& programs) {
  programs.start("baton", {"run", "--help"});
  return programs.finish().front().find("--in-process") != std::string::npos;
}

}  // namespace baton::bench
