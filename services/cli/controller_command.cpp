#include "controller_command.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "cell_target.hpp"
#include "runtime/json.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

struct LaunchWish {
  std::string name;
  std::string law;
  std::vector<std::string> parameters;  // "name=value"
};

msg::LaunchRequest requestFor(const LaunchWish& wish, msg::LaunchAction action) {
  std::string lines;
  for (const std::string& parameter : wish.parameters) lines += parameter + "\n";
  if (wish.name.size() >= msg::MAX_NAME) throw UsageError("controller names have at most 31 characters");
  if (wish.law.size() > 64) throw UsageError("--law: no law has such a long name; see `baton laws`");
  if (lines.size() > 2000) throw UsageError("--set: expected at most 2000 characters in all");
  msg::LaunchRequest request;
  request.request_id(CellClient::newRequestId());
  request.action(action);
  request.name(wish.name);
  request.law(wish.law);
  request.parameters(lines);
  return request;
}

/// Waits until the plant counts on it, or not any more.
bool standsBy(CellClient& client, const std::string& name, bool wanted) {
  const auto isSo = [&](const msg::BatonStatus& baton) {
    const bool stands =
        std::any_of(baton.members().begin(), baton.members().end(),
                    [&](const msg::BatonMember& member) { return name == member.name().c_str() && !member.failed(); });
    return stands == wanted;
  };
  bool is_so = false;
  client.collect<msg::BatonStatus>(dds::topics::kBatonStatus, [&](const std::vector<msg::BatonStatus>& all) {
    return is_so = !all.empty() && isSo(all.back());
  });
  return is_so;
}

void launch(const CellTarget& target, const LaunchWish& wish, msg::LaunchAction action, ExitCode& exit_code) {
  CellClient client(CellClient::find(target.domain, target.cell));
  const msg::LaunchRequest request = requestFor(wish, action);
  const auto reply = client.ask<msg::LaunchRequest, msg::LaunchReply>(
      dds::topics::kLaunchRequest, request, dds::topics::kLaunchReply,
      [&](const msg::LaunchReply& one) { return one.request_id() == request.request_id(); }, kSupervisorName);
  if (!reply) throw UnavailableError("the run's supervisor did not answer; see `baton logs supervisor`");
  const bool starts = action == msg::LAUNCH_START;
  const bool is_done = reply->accepted() && standsBy(client, wish.name, starts);
  const bool is_to_come = starts && reply->accepted() && !is_done && simStatus(client).state() == msg::SIM_STATE_PAUSED;
  exit_code = is_done ? ExitCode::kOk : is_to_come ? ExitCode::kUnavailable : ExitCode::kFailed;
  if (target.json) {
    sayText(toText(Json{{"accepted", reply->accepted()},
                        {"done", is_done},
                        {"pid", reply->pid()},
                        {"reason", reply->reason().c_str()}}) +
            '\n');
  } else if (!reply->accepted()) {
    say("refused: %s\n", reply->reason().c_str());
  } else if (is_to_come) {
    say("%s, process %d, joins when the run goes on: it is paused\n", wish.name.c_str(),
        static_cast<int>(reply->pid()));
  } else if (!is_done) {
    say("%s, process %d, %s; see `baton logs %s`\n", wish.name.c_str(), static_cast<int>(reply->pid()),
        starts ? "does not stand by yet" : "does not end; stop it again to kill it", wish.name.c_str());
  } else {
    say("%s %s, process %d\n", wish.name.c_str(), starts ? "stands by" : "has ended", static_cast<int>(reply->pid()));
  }
}

}  // namespace

void addControllerCommand(CLI::App& app, ExitCode& exit_code) {
  const auto target = std::make_shared<CellTarget>();
  const auto wish = std::make_shared<LaunchWish>();
  CLI::App* command = app.add_subcommand("controller", "start and stop controllers while the run goes on");
  command->require_subcommand(1);
  CLI::App* start = addCellCommand(*command, *target, "start", "a new one, or one that has ended; it stands by");
  start->add_option("name", wish->name, "its name")->required();
  start->add_option("--law", wish->law, "the law it runs (default: as the scenario has it)");
  start->add_option("--set", wish->parameters, "parameter=value, as in a scenario; may be given more than once");
  start->callback([=, &exit_code] { launch(*target, *wish, msg::LAUNCH_START, exit_code); });
  CLI::App* stop = addCellCommand(*command, *target, "stop", "end one that does not hold the baton");
  stop->add_option("name", wish->name, "its name")->required();
  stop->callback([=, &exit_code] { launch(*target, *wish, msg::LAUNCH_STOP, exit_code); });
}

}  // namespace baton
