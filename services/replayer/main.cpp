// The replayer: publishes a recording again, raw, on its topics and in its rhythm.

#include "options.hpp"
#include "replayer.hpp"
#include "runtime/log.hpp"
#include "runtime/run.hpp"
#include "runtime/say.hpp"
#include "summary.hpp"

int main(int argc, char** argv) {
  return baton::runGuarded("baton-replayer", [&] {
    baton::ReplayOptions options;
    if (!baton::parseReplayOptions(argc, argv, options)) return baton::ExitCode::kOk;
    baton::setUpLog("replayer");
    baton::Replayer replayer(options);
    baton::say(stderr, "replaying %s in domain %d, cell %s, run %s\n", options.file.c_str(), options.domain,
               options.cell.c_str(), options.run.c_str());
    const baton::ReplayResult result = replayer.run();
    baton::sayText((options.json ? jsonText(result, options) : summaryText(result, options)) + '\n');
    return exitCode(result);
  });
}
