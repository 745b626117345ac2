#include "bag/bag_command.hpp"

#include "bag/subcommands.hpp"

namespace baton {

void addBagCommand(CLI::App& app, ExitCode& exit_code) {
  CLI::App* bag = app.add_subcommand("bag", "look into a recording");
  bag->require_subcommand(1);
  addBagInfo(*bag, exit_code);
  addBagVerify(*bag, exit_code);
  addBagRecover(*bag, exit_code);
  addBagMerge(*bag, exit_code);
  addBagCut(*bag, exit_code);
  addBagHash(*bag, exit_code);
  addBagCat(*bag, exit_code);
  addBagExport(*bag, exit_code);
  addBagDiff(*bag, exit_code);
}

}  // namespace baton
