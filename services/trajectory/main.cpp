// The trajectory generator: what is wanted at each step, one step ahead.
#include "reference_source.hpp"
#include "runtime/run.hpp"

int main(int argc, char** argv) {
  return baton::runService(argc, argv, "trajectory", [](baton::Service& service) {
    baton::ReferenceSource source(service);
    return service.run();
  });
}
