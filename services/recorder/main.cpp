// The recorder: every topic of the cell, raw, into one MCAP file; with --traffic, all of a DDS domain, without a run.
#include <string_view>

#include "recorder.hpp"
#include "runtime/run.hpp"
#include "traffic/recorder.hpp"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "--traffic") {
    return baton::runGuarded("baton-recorder", [&] { return baton::recordTraffic(argc - 1, argv + 1); });
  }
  return baton::runService(argc, argv, "recorder", [](baton::Service& service) {
    baton::Recorder recorder(service);
    return recorder.run();
  });
}
