// Controllers that are started and stopped while the run goes on.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>

#include "control/law.hpp"
#include "runtime/scenario_edit.hpp"
#include "supervisor.hpp"

namespace baton {
namespace {

constexpr std::size_t kMaxReason = 399;

msg::LaunchReply refusal(const std::string& reason) {
  msg::LaunchReply reply;
  reply.reason(reason.substr(0, kMaxReason));
  return reply;
}

msg::LaunchReply acceptance(int pid) {
  msg::LaunchReply reply;
  reply.accepted(true);
  reply.pid(pid);
  return reply;
}

}  // namespace

void Supervisor::onLaunchRequest(const msg::LaunchRequest& request) {
  boost::asio::post(service_.executor(), [this, request] {
    msg::LaunchReply reply = request.action() == msg::LAUNCH_START ? startController(request) : stopController(request);
    reply.request_id(request.request_id());
    const std::lock_guard lock(service_.mutex());
    launch_out_.write(reply);
  });
}

Child* Supervisor::runningChild(const std::string& name) {
  const auto found = std::find_if(children_.begin(), children_.end(),
                                  [&](const auto& child) { return child->name() == name && child->isRunning(); });
  return found == children_.end() ? nullptr : found->get();
}

msg::LaunchReply Supervisor::startController(const msg::LaunchRequest& request) {
  const std::string name = request.name().c_str();
  const std::string law = request.law().c_str();
  if (stage_ != Stage::kRunning || startup_s_ < 0.0) return refusal("the run has not begun, or is over");
  if (runningChild(name) != nullptr) return refusal(name + " runs already; stop it first");
  try {
    if (!law.empty()) (void)findLaw(law);
    Scenario changed =
        parseScenario(scenario_.file, withController(scenario_.text, name, law, request.parameters().c_str()),
                      scenario_.robot_file, scenario_.robot_text);
    changed.recording.enabled = scenario_.recording.enabled;  // which the command line may have turned off
    (void)changed.controller(name);                           // from here on nothing is refused any more
    keepExperiment(deployment_.info, changed);
    scenario_ = std::move(changed);
    start("controller", name, scenario_.controller(name).law);
    return acceptance(runningChild(name)->pid());
  } catch (const std::exception& error) {
    return refusal(error.what());  // whatever is wrong with what was asked for, the run goes on
  }
}

msg::LaunchReply Supervisor::stopController(const msg::LaunchRequest& request) {
  const std::string name = request.name().c_str();
  Child* child = runningChild(name);
  if (child == nullptr) return refusal("no controller called " + name + " runs");
  if (roles_[name] != "controller") return refusal(name + " is no controller; `baton down` ends the run");
  const msg::BatonStatus baton = lastBatonStatus();
  if (baton.holder() == name) return refusal(name + " holds the baton: hand it over first");
  if (baton.incoming() == name)
    return refusal(name + " is about to take over, at step " + std::to_string(baton.at_step()));
  const bool was_asked = !asked_to_end_.insert(name).second;
  child->signal(SIGCONT);
  child->signal(was_asked ? SIGKILL : SIGTERM);
  return acceptance(child->pid());
}

}  // namespace baton
