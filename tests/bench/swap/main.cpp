// `baton bench swap`: how soon a handover takes effect, in real time and in lockstep.
#include <algorithm>
#include <iostream>

#include "report.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/run.hpp"

namespace baton::bench {

static ExitCode run(int argc, char** argv) {
  int swaps = 300;
  bool as_json = false;
  std::string only, cpus;
  int fifo = 0;
  std::vector<std::string> names;
  for (const SwapCase& one : allSwapCases()) names.push_back(one.name);
  CLI::App app{
      "Runs the scenario lab with all its parts and hands the baton round its controllers, one handover after the\n"
      "other: how long from the request to the first step of the new holder, and how many steps. Exit code 0 when all\n"
      "was measured, whatever the figures."};
  app.name("baton bench swap");
  app.add_option("--swaps", swaps, "handovers in each case")->check(CLI::Range(1, 100'000))->capture_default_str();
  app.add_option("--only", only, "only this case")->check(CLI::IsMember(names));
  CLI::Option* fifo_option = app.add_option("--fifo", fifo, "as in `baton run`");
  app.add_option("--cpus", cpus, "as in `baton run`");
  app.add_flag("--json", as_json, "print JSON; the table goes to standard error");
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;
  std::vector<std::string> scheduling;
  if (fifo_option->count() > 0) scheduling.insert(scheduling.end(), {"--fifo", std::to_string(fifo)});
  if (!cpus.empty()) scheduling.insert(scheduling.end(), {"--cpus", cpus});

  Programs programs;
  SwapResults results;
  for (const SwapCase& one : allSwapCases()) {
    if (only.empty() || only == one.name) results.emplace_back(one, measureHandovers(one, swaps, scheduling, programs));
  }
  const nlohmann::ordered_json report = toJson(swaps, results);
  printTable(report, as_json ? std::cerr : std::cout);
  if (as_json) std::cout << toText(report) << '\n';
  return ExitCode::kOk;
}

}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench-swap", [&] { return baton::bench::run(argc, argv); });
}
