// The environment: what the tip feels of the walls, step by step.
#include "runtime/run.hpp"
#include "wall_responder.hpp"

int main(int argc, char** argv) {
  return baton::runService(argc, argv, "environment", [](baton::Service& service) {
    baton::WallResponder responder(service);
    return service.run();
  });
}
