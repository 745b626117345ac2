// `baton bench`: what a step of the loop costs, beside the same messages on plain Fast DDS, in one interleaved run.
#include <iostream>

#include "bench.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/run.hpp"

namespace baton::bench {

static ExitCode run(int argc, char** argv) {
  Plan plan{.rounds = 5, .steps = 4000, .cases = {}};
  bool as_json = false;
  std::vector<std::string> only;
  CLI::App app{
      "Measures the steps of the loop, as processes on DDS, beside the same messages on plain Fast DDS: p50 and p99,\n"
      "with and without recorder and standby controllers, over UDP and shared memory, several cells at once,\n"
      "start-up and memory. The cases take turns, round after round. Exit code 0 when all was measured, whatever\n"
      "the figures."};
  app.name("baton bench");
  app.add_option("--rounds", plan.rounds, "how often every case is run")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--steps", plan.steps, "steps of a run")->check(CLI::Range(100, 10'000'000))->capture_default_str();
  app.add_option("--only", only, "only these cases; a part of a name stands for all that contain it");
  app.add_flag("--json", as_json, "print JSON; the table goes to standard error");
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;
  plan.cases = casesCalled(only);

  Programs programs;
  const nlohmann::ordered_json report = toJson(plan, measureAll(plan, programs));
  printTable(report, as_json ? std::cerr : std::cout);
  if (as_json) std::cout << toText(report) << '\n';
  return ExitCode::kOk;
}

}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench", [&] { return baton::bench::run(argc, argv); });
}
