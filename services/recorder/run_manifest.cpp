#include "run_manifest.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <array>

#include "dds/hash.hpp"
#include "msg/idl_text.hpp"
#include "runtime/build_id.hpp"

namespace baton {

mcap::StringMap runManifest(const ServiceOptions& options, const Scenario& scenario) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  std::uint64_t idl_hash = 0;
  for (const msg::IdlText& text : msg::allIdlTexts()) {
    idl_hash = dds::chainHash(idl_hash, std::as_bytes(std::span(text.text)));
  }
  return {{"version", BATON_VERSION},
          {"compiler", BATON_COMPILER},
          {"flags", BATON_FLAGS},
          {"build_id", buildId()},
          {"scenario", scenario.name},
          {"scenario_file", scenario.file},
          {"robot", scenario.robot.name},
          {"cell", options.cell},
          {"run", options.run},
          {"domain", std::to_string(options.domain)},
          {"checkpoint", options.checkpoint},
          {"step_ns", std::to_string(scenario.step_ns)},
          {"idl_hash", fmt::format("{:016x}", idl_hash)},
          {"host", host.data()}};
}

}  // namespace baton
