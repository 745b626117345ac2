#include <unistd.h>

#include <memory>
#include <string>

#include "bag/message_text.hpp"
#include "bag/selection.hpp"
#include "bag/subcommands.hpp"
#include "runtime/command_line.hpp"
#include "runtime/recorded_types.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

struct CatRequest {
  Selection selection;
  std::uint64_t limit = 0;  // 0: none
  bool raw = false;
};

ExitCode cat(const CatRequest& request) {
  SelectedMessages messages(request.selection);
  RecordedTypes types([&](const std::string& problem) { messages.complain(problem); });
  std::string line;
  std::uint64_t printed = 0;
  // On a terminal the lines themselves show how it goes.
  messages.forEach(isatty(STDOUT_FILENO) != 0 ? "" : "printing", [&](const mcap::MessageView& message) {
    line.clear();
    const std::string problem = appendJsonLine(line, message, request.raw ? nullptr : types.typeOf(message));
    if (!problem.empty()) {
      messages.complain("topic " + message.channel->topic + ", message " + std::to_string(message.sequence) +
                        " is none of its type: " + problem);
    }
    line += '\n';
    return sayRaw(line) && ++printed != request.limit;
  });
  return messages.exitCode();
}

}  // namespace

void addBagCat(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<CatRequest>();
  CLI::App* command = bag.add_subcommand("cat", "the messages, decoded, one JSON object a line");
  command->footer(
      std::string(kRangeHelp) +
      "Messages are decoded with the IDL text that the recording carries; those of a topic without one are printed as\n"
      "their bytes in hex, \"data\", beside the name of their type. Numbers read back as exactly what was recorded.\n"
      "64-bit integers are JSON integers with all their digits: read them with a reader that keeps more than 53\n"
      "bits (Python and jq 1.7 do, JavaScript's JSON.parse does not). NaN, Infinity and -Infinity are strings,\n"
      "enums are their names, octets in a sequence or an array are hex.\n"
      "Exit codes: 0 all was printed, 1 some of it is cut, damaged or none of its type and the rest was printed,\n"
      "2 wrong input or not a recording, 3 cannot be opened or printed.");
  addTopicSelection(*command, request->selection);
  addRange(*command, request->selection.range);
  command->add_option("--limit", request->limit, "end after so many messages")->check(atLeastOne());
  command->add_flag("--raw", request->raw, "bytes in hex, whatever the topic");
  command->callback([request, &exit_code] { exit_code = cat(*request); });
}

}  // namespace baton
