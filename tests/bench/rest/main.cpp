// `baton bench rest`: what cells at rest cost the machine, and a run that starts beside them.
#include "measure.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/run.hpp"
#include "runtime/say.hpp"

namespace baton::bench {

static ExitCode run(int argc, char** argv) {
  int cells = 8;
  double seconds = 20.0;
  bool as_json = false;
  CLI::App app{
      "Starts cells of one robot, three controllers and no recorder, all at once in one DDS domain, paused before\n"
      "their first step, and tells what CPU time they take together and how soon another run starts beside them.\n"
      "Exit code 0 when all was measured, whatever the figures."};
  app.name("baton bench rest");
  app.add_option("--cells", cells, "how many")->check(CLI::Range(1, 20))->capture_default_str();
  app.add_option("--seconds", seconds, "how long they are watched at rest")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  app.add_flag("--json", as_json, "print JSON");
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;

  Programs programs;
  const RestCost cost = measureRest(cells, seconds, programs);
  if (as_json) {
    sayText(toText(nlohmann::ordered_json{{"cells", cells},
                                          {"processes", cost.processes},
                                          {"started_s", cost.started_s},
                                          {"cpu_cores", cost.cpu_cores},
                                          {"beside_startup_s", cost.beside_startup_s}}) +
            '\n');
    return ExitCode::kOk;
  }
  sayf(
      "{} cells, {} processes: started in {:.1f} s; at rest {:.1f} % of a core together; a run beside them starts in "
      "{:.2f} s\n",
      cells, cost.processes, cost.started_s, 100.0 * cost.cpu_cores, cost.beside_startup_s);
  return ExitCode::kOk;
}

}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench-rest", [&] { return baton::bench::run(argc, argv); });
}
