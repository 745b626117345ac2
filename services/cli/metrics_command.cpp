#include "metrics_command.hpp"

#include <cstdio>
#include <memory>
#include <string>

#include "report/metrics.hpp"
#include "runtime/json.hpp"

namespace baton {

void addMetricsCommand(CLI::App& app) {
  const auto file = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("metrics", "errors, efforts and contact forces of a recorded run, in numbers");
  command->footer(
      "Errors are desired minus actual. Overshoot and settling are of the way from where a signal starts to its\n"
      "set-point; settled means within 2 % of that way for good. A dash: the desired value moves, there is no way, or\n"
      "what it takes was not recorded.");
  command->add_option("file", *file, "recording (MCAP)")->required();
  command->add_flag("--json", *json, "print JSON");
  command->callback([=] {
    const Trace trace = readTrace(*file);
    if (!trace.is_complete) std::fprintf(stderr, "baton: warning: %s is not certified complete\n", file->c_str());
    const Metrics metrics = metricsOf(trace);
    std::puts((*json ? toText(toJson(metrics)) : toText(metrics)).c_str());
  });
}

}  // namespace baton
