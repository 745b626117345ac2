// The recorder: every topic of the cell, raw, into one MCAP file.
#include "recorder.hpp"
#include "runtime/run.hpp"

int main(int argc, char** argv) {
  return baton::runService(argc, argv, "recorder", [](baton::Service& service) {
    baton::Recorder recorder(service);
    return recorder.run();
  });
}
