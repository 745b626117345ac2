// Fuzz target: words as people type them after an option that takes a number, a rate, processors, a parameter or a
// setting, each on a line of its own. A number that is taken is finite and within what the option says.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "parameter_setting.hpp"
#include "runtime/command_line.hpp"
#include "runtime/scenario_edit.hpp"
#include "runtime/scheduling.hpp"

namespace {

using namespace baton;

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Read>
void tryTo(const Read& read) {
  try {
    read();
  } catch (const UsageError&) {
  }
}

void parseOptions(const std::string& word) {
  CLI::App app;
  std::uint64_t steps = 0, count = 1;
  int whole = 0;
  double number = 0.0, length = 0.0;
  std::string cell = "lab";
  Scheduling scheduling;
  app.add_option("--steps", steps);
  app.add_option("--count", count)->check(atLeastOne());
  app.add_option("--whole", whole);
  app.add_option("--number", number);
  app.add_option("--length", length)->check(notNegative());
  addCell(app, cell);
  addScheduling(app, scheduling);
  const char* const arguments[] = {"baton", word.c_str()};
  if (!parseCommandLine(app, 2, arguments)) return;  // help
  require(std::isfinite(number) && std::isfinite(length) && length >= 0.0 && count >= 1);
  require(!cell.empty() && cell.size() < 32);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  for (std::string word; std::getline(lines, word);) {
    tryTo([&] {
      const double rate = parseRate("--rate", word, kMaxReplayRate);
      require(std::isfinite(rate) && (rate == 0.0 || rate >= 1e-7));
    });
    tryTo([&] { (void)parseCpus(word); });
    tryTo([&] { (void)parseParameter(word); });
    tryTo([&] { (void)editScenario("controllers: [{name: a}]\n", {parseSetting(word)}); });
    if (word.starts_with("--") && !word.starts_with("--help")) tryTo([&] { parseOptions(word); });
  }
  return 0;
}
