// The plant: the simulated arm, time's master and the judge of who holds the baton.
#include "plant.hpp"
#include "runtime/cell.hpp"
#include "runtime/run.hpp"

int main(int argc, char** argv) {
  return baton::runService(argc, argv, "plant", [](baton::Service& service) {
    const baton::ServiceOptions& options = service.options();
    const baton::PlantLock lock(options.domain, options.cell, options.run);
    baton::Plant plant(service);
    return service.run();
  });
}
