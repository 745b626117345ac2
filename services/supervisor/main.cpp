// The supervisor: starts the processes of a run, watches them, ends them in order.
#include "runtime/run.hpp"
#include "supervise.hpp"

int main(int argc, char** argv) {
  return baton::runGuarded("baton-supervisor", [&] { return baton::supervise(argc, argv); });
}
