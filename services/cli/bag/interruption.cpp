#include "bag/interruption.hpp"

#include <unistd.h>

#include <string_view>

#include "base/error.hpp"
#include "mcap/file.hpp"
#include "runtime/signals.hpp"

namespace baton {
namespace {

extern "C" void endNow(int /*signal*/) {
  constexpr std::string_view kText = "\nbaton: interrupted: what was not finished is removed\n";
  mcap::OutputFile::removeUnfinished();
  [[maybe_unused]] const ssize_t told = ::write(STDERR_FILENO, kText.data(), kText.size());
  ::_exit(static_cast<int>(ExitCode::kInterrupted));
}

}  // namespace

void removeUnfinishedOnSignals() {
  struct sigaction action {};
  action.sa_handler = endNow;
  sigfillset(&action.sa_mask);
  for (const int number : endingSignals()) sigaction(number, &action, nullptr);
}

}  // namespace baton
