// `baton bench recording`: what a recording costs, from the writer alone to `bag verify`, beside its targets.
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "measure.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/run.hpp"

namespace baton::bench {

static ExitCode run(int argc, char** argv) {
  Plan plan;
  bool as_json = false;
  std::string only;
  std::string disk = std::filesystem::temp_directory_path().string();
  CLI::App app{
      "Measures what a recording costs: the writer alone, to memory and to disk, and a large file read, verified and\n"
      "recovered. Medians over the rounds. Exit code 0 when all was measured, whatever the figures."};
  app.name("baton bench recording");
  app.add_option("--size", plan.megabytes, "MB of the file that is read")
      ->check(CLI::Range(10, 100'000))
      ->capture_default_str();
  app.add_option("--written", plan.written_megabytes, "MB of payload in one run of the writer")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--rounds", plan.rounds, "how often each is done")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--disk", disk, "a folder on the disk")->capture_default_str();
  app.add_option("--only", only, "write or read")->check(CLI::IsMember({"write", "read"}));
  app.add_flag("--json", as_json, "print JSON; the table goes to standard error");
  if (!parseCommandLine(app, argc, argv)) return ExitCode::kOk;
  plan.disk = disk;

  std::vector<Row> rows;
  const Report report = [&](const Row& row) {
    print(as_json ? stderr : stdout, row);  // as it is known: that is the progress
    rows.push_back(row);
  };
  if (only != "read") measureWriter(plan, report);
  if (only != "write") measureReader(plan, report);
  if (as_json) std::cout << toText(toJson(rows)) << '\n';
  return ExitCode::kOk;
}

}  // namespace baton::bench

int main(int argc, char** argv) {
  return baton::runGuarded("baton-bench-recording", [&] { return baton::bench::run(argc, argv); });
}
