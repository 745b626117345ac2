#include "run_manifest.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/utsname.h>

#include <array>
#include <chrono>
#include <ctime>
#include <string>
#include <thread>
#include <vector>

#include "dds/hash.hpp"
#include "msg/idl_text.hpp"
#include "runtime/build_id.hpp"
#include "runtime/paths.hpp"
#include "runtime/platform.hpp"

namespace baton {
namespace {

/// As in "2026-11-22T04:01:35Z".
std::string utcNow() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm broken{};
  gmtime_r(&now, &broken);
  std::array<char, 32> text{};
  (void)std::strftime(text.data(), text.size(), "%FT%TZ", &broken);
  return text.data();
}

/// All that is random in a run: the noise that the trajectory holds, and faults that strike by chance.
std::string seedsOf(const Scenario& scenario) {
  std::vector<std::string> seeds;
  if (const auto& noise = scenario.trajectory.noise) seeds.push_back(fmt::format("trajectory {}", noise->seed));
  for (const Fault& fault : scenario.faults) {
    if (fault.probability < 1.0) seeds.push_back(fmt::format("{} of {} {}", fault.topic, fault.service, fault.seed));
  }
  return fmt::format("{}", fmt::join(seeds, ", "));
}

}  // namespace

mcap::StringMap factsOfProgram() {
  utsname host{};
  (void)uname(&host);
  std::uint64_t idl_hash = 0;
  for (const msg::IdlText& text : msg::allIdlTexts()) {
    idl_hash = dds::chainHash(idl_hash, std::as_bytes(std::span(text.text)));
  }
  mcap::StringMap facts = platform();
  facts.merge(mcap::StringMap{{"version", BATON_VERSION},
                              {"compiler", BATON_COMPILER},
                              {"flags", BATON_FLAGS},
                              {"idl_hash", fmt::format("{:016x}", idl_hash)},
                              {"begun", utcNow()},
                              {"host", host.nodename},
                              {"system", fmt::format("{} {} {}", host.sysname, host.release, host.machine)},
                              {"cores", std::to_string(std::thread::hardware_concurrency())}});
  return facts;
}

namespace {

mcap::StringMap manifestOf(const ServiceOptions& options, const Scenario& scenario) {
  mcap::StringMap manifest = factsOfProgram();
  manifest.merge(mcap::StringMap{{"build_id", buildId()},
                                 {"scenario", scenario.name},
                                 {"scenario_file", scenario.file},
                                 {"robot", scenario.robot.name},
                                 {"cell", options.cell},
                                 {"run", options.run},
                                 {"domain", std::to_string(options.domain)},
                                 {"checkpoint", options.checkpoint},
                                 {"step_ns", std::to_string(scenario.step_ns)},
                                 {"seed", seedsOf(scenario)}});
  return manifest;
}

}  // namespace

Origin originOf(const ServiceOptions& options, const Scenario& scenario) {
  Origin origin{.run = manifestOf(options, scenario),
                .attachments = {{"scenario.yaml", "application/yaml", scenario.text},
                                {"robot.yaml", "application/yaml", scenario.robot_text}}};
  if (!options.checkpoint.empty()) {
    origin.attachments.push_back({"checkpoint.mcap", "application/octet-stream", readFile(options.checkpoint)});
  }
  return origin;
}

}  // namespace baton
