#include "sync_cost.hpp"

#include <unistd.h>

#include "scenario.hpp"

namespace baton::bench {

double stepsPerSecond(const std::string& sync, int steps, const std::filesystem::path& file, Programs& programs) {
  const std::string scenario =
      programs.write("sync.yaml", scenarioText(true, 0, steps) + "recording: {sync: " + sync + "}\n");
  const nlohmann::json result = programs.run(
      "baton", {"run", scenario, "--out", file.string(), "--overwrite", "--cell", "bench-" + std::to_string(getpid()),
                "--domain", std::to_string(programs.domain()), "--json"});
  return result.at("steps").get<double>() / result.at("elapsed_s").get<double>();
}

}  // namespace baton::bench
