#include "player_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "cell_target.hpp"
#include "messages/state_names.hpp"
#include "runtime/command_line.hpp"
#include "runtime/json.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

constexpr const char* kReplayer = "replayer";

struct PlayerArguments {
  CellTarget target{.cell = "replay"};
  std::string run;
  msg::ReplayRequest request;
};

double inSeconds(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

bool isGoingOn(const msg::ReplayStatus& status) { return status.state() != msg::REPLAY_FINISHED; }

/// By what discovery tells. Any process can say that it is a replay, so only where there is none of this user's.
std::set<std::string> replaysOfOthers(const RunInfo& place) {
  CellClient observer(place);
  std::ignore = observer.collect<msg::ReplayStatus>(
      dds::topics::kReplayStatus, [](const auto& all) { return std::ranges::any_of(all, isGoingOn); },
      CellClient::kStatusPatience);
  std::set<std::string> runs;
  for (const dds::Peer& peer : observer.peers()) {
    const bool is_meant = place.run == "*" || peer.run == place.run;
    if (peer.service == kReplayer && peer.cell == place.cell && is_meant && isFileName(peer.run, "")) {
      runs.insert(peer.run);
    }
  }
  return runs;
}

UnavailableError nothingIsReplayed(const PlayerArguments& arguments) {
  return UnavailableError(fmt::format(
      "nothing is replayed in cell {} of domain {}{}: start it with `baton replay FILE`, or say --cell, --domain and "
      "--run of the one that is meant",
      arguments.target.cell, arguments.target.domain, arguments.run.empty() ? "" : " as run " + arguments.run));
}

/// The replay that is meant. Throws UnavailableError when there is none, UsageError when there are several.
RunInfo findReplay(const PlayerArguments& arguments) {
  RunInfo place;
  place.cell = arguments.target.cell;
  place.run = arguments.run.empty() ? "*" : arguments.run;
  place.domain = arguments.target.domain;
  std::set<std::string> runs = replaysOfThisUser(place.domain, place.cell);
  if (place.run != "*") std::erase_if(runs, [&](const std::string& run) { return run != place.run; });
  if (runs.empty()) runs = replaysOfOthers(place);
  if (runs.empty()) throw nothingIsReplayed(arguments);
  if (runs.size() > 1) {
    throw UsageError(fmt::format("expected to be told which replay of cell {} is meant: --run {}", place.cell,
                                 fmt::join(runs, ", --run ")));
  }
  place.run = *runs.begin();
  place.folder = replayFolder(place.domain, place.cell, place.run).string();
  return place;
}

/// Throws UnavailableError when it says nothing, or has finished.
msg::ReplayStatus statusOf(CellClient& client, const PlayerArguments& arguments) {
  const auto status = client.latest(dds::topics::kReplayStatus, CellClient::kStatusPatience);
  if (!status || !isGoingOn(*status)) throw nothingIsReplayed(arguments);
  return *status;
}

void tell(const PlayerArguments& arguments) {
  const RunInfo place = findReplay(arguments);
  CellClient client(place);
  const msg::ReplayStatus status = statusOf(client, arguments);
  const double position_s = inSeconds(status.position_ns());
  const double duration_s = inSeconds(status.duration_ns());
  if (arguments.target.json) {
    sayText(
        toText(Json{
            {"file", status.path().c_str()},
            {"domain", place.domain},
            {"cell", place.cell},
            {"run", place.run},
            {"state", toString(status.state())},
            {"waiting_for", status.waiting_for().c_str()},
            {"position_s", position_s},
            {"duration_s", duration_s},
            {"pass", status.pass()},
            {"passes", status.passes()},
            {"rate", status.rate()},
            {"messages", status.messages()},
            {"total", status.total()},
            {"lateness_us",
             {{"p50", status.lateness_p50_us()}, {"p99", status.lateness_p99_us()}, {"max", status.lateness_max_us()}}},
            {"overdue", status.overdue()}}) +
        '\n');
    return;
  }
  std::string text = fmt::format("{} in cell {}, run {}\n{} at {:.6f} of {:.6f} s, {}", escaped(status.path().c_str()),
                                 place.cell, place.run, toString(status.state()), position_s, duration_s,
                                 status.rate() > 0.0 ? fmt::format("rate {:g}", status.rate()) : "as fast as possible");
  if (status.passes() != 1) text += fmt::format(", pass {}", status.pass());
  if (status.passes() > 1) text += fmt::format(" of {}", status.passes());
  if (status.waiting_for().size() > 0) text += fmt::format(", waits for {}", escaped(status.waiting_for().c_str()));
  text += fmt::format(
      "\n{} sent, of {} in a pass; lateness p50 {:.1f} us, p99 {:.1f} us, max {:.1f} us, {} "
      "overdue\n",
      counted(status.messages(), "message"), status.total(), status.lateness_p50_us(), status.lateness_p99_us(),
      status.lateness_max_us(), status.overdue());
  sayText(text);
}

void ask(const PlayerArguments& arguments, ExitCode& exit_code) {
  const RunInfo place = findReplay(arguments);
  CellClient client(place);
  const msg::ReplayStatus status = statusOf(client, arguments);
  std::error_code is_hidden;
  if (!std::filesystem::exists(keyFile(place), is_hidden)) {
    throw UnavailableError("run " + place.run + " of cell " + place.cell +
                           " takes requests from the user who started it, with the same BATON_HOME");
  }
  msg::ReplayRequest request = arguments.request;
  request.request_id(CellClient::newRequestId());
  // A step is answered when it is done; replays manage ten messages in a millisecond. One message of a rare topic may
  // have all others in front of it.
  const std::uint64_t sent_at_most = request.topic().size() > 0 ? status.total() : request.messages();
  const auto patience =
      CellClient::kPatience + std::chrono::milliseconds(std::min<std::uint64_t>(sent_at_most, 3'600'000));
  const auto reply = client.ask<msg::ReplayRequest, msg::ReplayReply>(
      dds::topics::kReplayRequest, request, dds::topics::kReplayReply,
      [&](const msg::ReplayReply& one) { return one.request_id() == request.request_id(); }, kReplayer, patience);
  if (!reply) throw UnavailableError("the replayer did not answer; see `baton player status`");
  exit_code = reply->accepted() ? ExitCode::kOk : ExitCode::kFailed;
  const double position_s = inSeconds(reply->position_ns());
  if (arguments.target.json) {
    sayText(toText(Json{{"accepted", reply->accepted()},
                        {"position_s", position_s},
                        {"messages", reply->messages()},
                        {"reason", reply->reason().c_str()}}) +
            '\n');
  } else if (reply->accepted()) {
    sayText(fmt::format("done at {:.6f} s, {} sent\n", position_s, counted(reply->messages(), "message")));
  } else {
    sayText(fmt::format("refused at {:.6f} s: {}\n", position_s, reply->reason().c_str()));
  }
}

}  // namespace

void addPlayerCommand(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<PlayerArguments>();
  CLI::App* command = app.add_subcommand("player", "a replay that goes on: pause, step, seek, change the rate, stop");
  command->require_subcommand(1);
  command->footer(
      "Exit codes: 0 done, 1 refused or cut short, 2 wrong input, or several replays go on and none is named,\n"
      "3 nothing is replayed there, it does not answer, or it is another user's.");
  const auto addSub = [&](const char* name, const char* help) {
    CLI::App* sub = addCellCommand(*command, arguments->target, name, help);
    sub->add_option("--run", arguments->run, "its run, where several go on in a cell");
    return sub;
  };
  const auto add = [&](const char* name, const char* help, msg::ReplayAction action) {
    CLI::App* sub = addSub(name, help);
    sub->callback([=, &exit_code] {
      arguments->request.action(action);
      ask(*arguments, exit_code);
    });
    return sub;
  };
  addSub("status", "where it stands")->callback([=] { tell(*arguments); });
  add("pause", "hold it in front of its next message", msg::REPLAY_PAUSE);
  add("resume", "go on, with what was left of the wait for that message", msg::REPLAY_RESUME);
  add("stop", "end it here, in order", msg::REPLAY_STOP);
  CLI::App* step = add("step", "send N messages as fast as possible, then hold", msg::REPLAY_STEP);
  arguments->request.messages(1);
  step->add_option_function<std::uint64_t>(
          "n", [=](const std::uint64_t& n) { arguments->request.messages(n); }, "how many")
      ->default_str("1");
  step->add_option_function<std::string>(
      "--topic", [=](const std::string& topic) { arguments->request.topic(topic); },
      "N messages of this topic, as it was recorded, and all that lie before them: plant_state steps the loop");
  add("seek", "stand there, in s from the recording's first message; goes on or holds as before", msg::REPLAY_SEEK)
      ->add_option_function<double>(
          "position",
          [=](const double& position_s) {
            if (!(std::abs(position_s) < 1e9)) throw UsageError("player seek: expected a time in seconds");
            arguments->request.position_ns(std::llround(position_s * 1e9));
          },
          "S")
      ->required();
  add("rate", "recorded seconds per second, or max", msg::REPLAY_RATE)
      ->add_option_function<std::string>(
          "rate",
          [=](const std::string& text) { arguments->request.rate(parseRate("player rate", text, kMaxReplayRate)); },
          "X or max")
      ->required();
}

}  // namespace baton
