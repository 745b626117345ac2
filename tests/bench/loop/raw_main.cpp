// The yardstick of `baton bench`: the loop's messages, QoS, transports and number of processes on plain Fast DDS, as
// one would write it who needs nothing else.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "raw_chain.hpp"

int main(int argc, char** argv) {
  raw::Chain chain{.network = {.partition = "raw/" + std::to_string(getpid())}, .warm_up = 200, .steps = 4000};
  CLI::App app{"The loop's messages on plain Fast DDS, for comparison: prints the time of a step as JSON."};
  app.add_option("--hops", chain.hops, "3: the controller waits for the contact; 2: it does not")
      ->check(CLI::Range(2, 3))
      ->capture_default_str();
  app.add_flag("--shm", chain.network.shared_memory, "over shared memory instead of UDP");
  app.add_flag("--observed", chain.observed, "with one more process that reads everything");
  app.add_option("--warm-up", chain.warm_up, "steps that are not counted")->capture_default_str();
  app.add_option("--steps", chain.steps, "steps that are")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--domain", chain.network.domain, "DDS domain")->check(CLI::Range(0, 232))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    raw::runChain(chain);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "baton-raw-chain: " << error.what() << '\n';
    return 1;
  }
}
