#include "runtime/command_line.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/number.hpp"
#include "control/nearest_name.hpp"
#include "mcap/error.hpp"
#include "time/pacer.hpp"

namespace baton {

namespace {

std::string refusal(const std::string& expected, const std::string& text) {
  return "expected " + expected + ", found '" + text + "'" + commaHint(text);
}

/// CLI11 takes -1 for a large unsigned number, and nan and inf for numbers.
void guardNumbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("UINT")) {
      option->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            return numberIn<std::uint64_t>(text) ? "" : refusal("a whole number from 0 on", text);
          },
          ""));
    } else if (type.starts_with("FLOAT")) {
      option->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            return numberIn<double>(text) ? "" : refusal("a finite number", text);
          },
          ""));
    }
  }
  for (CLI::App* command : app.get_subcommands({})) guardNumbers(*command);
}

std::vector<std::string> subcommandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

/// How far a line names commands.
struct Reached {
  const CLI::App* command;
  std::string words;      // each with a space in front
  std::string next_word;  // empty at the end of the line
};

Reached reachedBy(const CLI::App& app, int argc, const char* const* argv) {
  Reached reached{.command = &app, .words = "", .next_word = ""};
  for (int i = 1; i < argc; ++i) {
    reached.next_word = argv[i];
    const std::vector<const CLI::App*> all = reached.command->get_subcommands({});
    const auto named =
        std::find_if(all.begin(), all.end(), [&](const CLI::App* one) { return one->get_name() == reached.next_word; });
    if (named == all.end()) return reached;
    reached = {.command = *named, .words = reached.words + " " + reached.next_word, .next_word = ""};
  }
  return reached;
}

/// What CLI11 says, where its words are not ours.
std::string textOf(const CLI::ParseError& error, int argc, const char* const* argv) {
  std::string text = error.what();
  static const std::string kTwice = ": At Most 1 required but received ", kDomain = "--domain:";
  if (const std::size_t at = text.find(kTwice); at != std::string::npos) {
    text = text.substr(0, at) + ": expected once, found " + text.substr(at + kTwice.size()) + " times";
  }
  const bool is_given =
      std::any_of(argv, argv + argc, [](const char* word) { return std::string_view(word).starts_with("--domain"); });
  if (text.starts_with(kDomain) && !is_given) {
    text = "BATON_DOMAIN in the environment:" + text.substr(kDomain.size());
  }
  return text;
}

}  // namespace

bool parseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  guardNumbers(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    app.exit(help);
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(textOf(error, argc, argv) + " (see --help)");
  }
  return true;
}

void runCommand(CLI::App& app, int argc, const char* const* argv) {
  guardNumbers(app);
  try {
    app.parse(argc, argv);
  } catch (const mcap::NotARecording&) {
    throw;
  } catch (const mcap::FormatError& error) {
    throw UsageError(error.what() + std::string("; `") + app.get_name() +
                     " bag recover` makes a recording of all that can be read");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // the help or the version
      app.exit(error);
      return;
    }
    const Reached reached = reachedBy(app, argc, argv);
    // CLI11 would ask for a subcommand without naming the word that is none.
    const std::vector<std::string> known = subcommandsOf(*reached.command);
    if (!known.empty() && !reached.next_word.empty() && !reached.next_word.starts_with('-')) {
      throw UsageError(
          unknownName(reached.words.empty() ? "command" : "command of" + reached.words, reached.next_word, known));
    }
    const std::string about = reached.words.empty() ? "" : reached.words.substr(1) + ": ";
    throw UsageError(about + textOf(error, argc, argv) + "; see `" + app.get_name() + reached.words + " --help`");
  }
}

CLI::Option* addCell(CLI::App& app, std::string& cell) {
  const auto complaint = [](const std::string& name) -> std::string {
    const bool is_good = !name.empty() && name.size() < 32 && std::all_of(name.begin(), name.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    });
    return is_good ? "" : "expected 1 to 31 of A-Z a-z 0-9 _ -, found " + name;
  };
  return app.add_option("--cell", cell, "cell: one robot with its parts")
      ->check(CLI::Validator(complaint, "NAME"))
      ->capture_default_str();
}

CLI::Option* addDomain(CLI::App& app, int& domain) {
  return app.add_option("--domain", domain, "DDS domain")->check(wholeBetween(0, 232))->capture_default_str();
}

CLI::Option* addTransport(CLI::App& app, dds::Transport& transport) {
  return app
      .add_option_function<std::string>(
          "--transport",
          [&transport](const std::string& name) { transport = dds::transportCalled(name).value_or(transport); },
          "udp, or shm: faster, but after kill -9 shared memory leaves files in /dev/shm behind")
      ->check(CLI::IsMember({"udp", "shm"}))
      ->default_str(dds::toString(transport));
}

CLI::Option* addClock(CLI::App& app, dds::WallClock& clock) {
  return app.add_option_function<std::int64_t>(
      "--clock-offset", [&clock](const std::int64_t& offset_ns) { clock = dds::WallClock(offset_ns); },
      "ns from the machine's steady clock to the run's wall clock (default: as the wall clock is now)");
}

double parseRate(const std::string& what, const std::string& text, double highest) {
  if (text == "max") return 0.0;
  const auto rate = numberIn<double>(text);
  if (!rate || *rate < kMinRate || *rate > highest) {
    throw UsageError(what + ": " + refusal(fmt::format("a number from {:g} to {:g}, or max", kMinRate, highest), text));
  }
  return *rate;
}

CLI::Validator notNegative() {
  return {[](const std::string& text) -> std::string {
            const auto number = numberIn<double>(text);
            return number && *number >= 0.0 ? "" : refusal("a number that is not below 0", text);
          },
          "NONNEGATIVE"};
}

CLI::Validator atLeastOne() {
  return {[](const std::string& text) -> std::string {
            const auto number = numberIn<std::uint64_t>(text);
            return number && *number > 0 ? "" : refusal("a whole number from 1 on", text);
          },
          "COUNT"};
}

CLI::Validator wholeBetween(std::int64_t low, std::int64_t high) {
  return {[=](const std::string& text) -> std::string {
            const auto number = numberIn<std::int64_t>(text);
            const bool is_right = number && *number >= low && *number <= high;
            return is_right ? "" : refusal(fmt::format("a whole number from {} to {}", low, high), text);
          },
          fmt::format("{} to {}", low, high)};
}

CLI::Validator between(double low, double high) {
  return {[=](const std::string& text) -> std::string {
            const auto number = numberIn<double>(text);
            const bool is_right = number && *number >= low && *number <= high;
            return is_right ? "" : refusal(fmt::format("a number from {:g} to {:g}", low, high), text);
          },
          fmt::format("{:g} to {:g}", low, high)};
}

void addScheduling(CLI::App& app, Scheduling& scheduling) {
  const auto complaint = [](const std::string& text) -> std::string {
    try {
      (void)parseCpus(text);
      return "";
    } catch (const UsageError& error) {
      return error.what();
    }
  };
  app.add_option("--fifo", scheduling.fifo_priority, "SCHED_FIFO priority of the loop's processes, where allowed")
      ->check(wholeBetween(1, 99));
  app.add_option("--cpus", scheduling.cpus, "cores that the loop's processes stay on: 0,2")
      ->check(CLI::Validator(complaint, "LIST"));
}

}  // namespace baton
