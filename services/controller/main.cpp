// A controller: one law in a process of its own.
#include "law_runner.hpp"
#include "runtime/run.hpp"

int main(int argc, char** argv) {
  return baton::runService(argc, argv, "controller", [](baton::Service& service) {
    baton::LawRunner runner(service);
    return service.run();
  });
}
