#include "cell_target.hpp"

#include <cmath>

#include "run_commands.hpp"

namespace baton {

CLI::App* addCellCommand(CLI::App& app, CellTarget& target, const char* name, const char* help) {
  CLI::App* command = app.add_subcommand(name, help);
  addCellOptions(*command, target.cell, target.domain);
  command->add_flag("--json", target.json, "print JSON");
  return command;
}

msg::SimStatus simStatus(CellClient& client) {
  const auto status = client.latest(dds::topics::kSimStatus);
  if (!status) {
    throw UnavailableError("the plant of run " + client.info().run + " says nothing; see `baton logs plant`");
  }
  return *status;
}

std::uint64_t stepToCome(std::uint64_t step) {
  if (step == 0) throw UsageError("--at 0: expected a step that is still to come; leave --at out for now");
  return step;
}

std::uint64_t stepAt(CellClient& client, double time_s) {
  const double steps = std::round(time_s * 1e9 / static_cast<double>(simStatus(client).step_ns()));
  if (!(steps >= 1.0 && steps < 1e18)) throw UsageError("--at-time: expected a time after the first step");
  return static_cast<std::uint64_t>(steps);
}

}  // namespace baton
