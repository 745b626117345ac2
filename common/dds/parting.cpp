#include "dds/parting.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace baton::dds {
namespace {
std::atomic<bool> has_leftover = false;
}

void noteLeftover() noexcept { has_leftover = true; }

int leave(int exit_code) {
  if (!has_leftover) return exit_code;
  std::cout.flush();
  std::fflush(nullptr);
  std::_Exit(exit_code);
}

}  // namespace baton::dds
