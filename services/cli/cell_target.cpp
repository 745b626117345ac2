#include "cell_target.hpp"

#include <chrono>
#include <cmath>
#include <tuple>

#include "run_commands.hpp"
#include "runtime/command_line.hpp"

namespace baton {

CLI::App* addCellCommand(CLI::App& app, CellTarget& target, const char* name, const char* help) {
  CLI::App* command = app.add_subcommand(name, help);
  addCellOptions(*command, target.cell, target.domain);
  command->add_flag("--json", target.json, "print JSON");
  return command;
}

msg::SimStatus simStatus(CellClient& client) {
  constexpr std::chrono::seconds kLook{2};
  for (std::chrono::seconds waited{0}; waited < CellClient::kPatience; waited += kLook) {
    if (const auto status = client.latest(dds::topics::kSimStatus, kLook)) return *status;
    std::ignore =
        CellClient::find(client.info().domain, client.info().cell);  // throws when the run has ended meanwhile
  }
  throw UnavailableError("the plant of run " + client.info().run + " says nothing; see `baton logs plant`");
}

std::uint64_t stepToCome(std::uint64_t step) {
  if (step == 0) throw UsageError("--at 0: expected a step that is still to come; leave --at out for now");
  return step;
}

void addAtTime(CLI::App& command, std::optional<double>& at_s, CLI::Option* at) {
  command.add_option("--at-time", at_s, "the same in seconds of the run")->excludes(at)->check(between(0.0, 1e9));
}

std::uint64_t stepAt(CellClient& client, double time_s) {
  const double steps = std::round(time_s * 1e9 / static_cast<double>(simStatus(client).step_ns()));
  if (!(steps >= 1.0 && steps < 1e18)) throw UsageError("--at-time: expected a time after the first step");
  return static_cast<std::uint64_t>(steps);
}

}  // namespace baton
