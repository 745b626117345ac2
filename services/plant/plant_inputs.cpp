// What arrives at the plant: contacts, commands, the operator's requests, the services' readiness.
#include <cmath>
#include <utility>

#include "control/law.hpp"
#include "plant.hpp"

namespace baton {
void Plant::onContact(const msg::Contact& message, const dds::RawSample& sample) {
  if (message.step() != master_.step() || master_.hasContact()) return;
  if (const Reading reading = fromMessage(message, contact_); !reading) {
    return onBadInput(message.step(), badInputText(dds::topics::kContact.name, message.step(), reading.text()));
  }
  hashes_.contact = dds::chainHash(0, sample.payload);
  master_.contactArrived(message.step());
  proceed();
}

void Plant::onCommand(const msg::JointCommand& message, const dds::RawSample& sample) {
  const int member = memberCalled(message.controller().c_str());
  if (!speaksFor(member, sample) || master_.isOver()) return;
  if (message.step() > master_.step() && master_.phase() != SimPhase::kStarting && !arbiter_.hasFailed(member)) {
    // Its state is known to nobody yet.
    ReasonText wrong{};
    write(wrong, "it commanded step %llu while step %llu was open", static_cast<unsigned long long>(message.step()),
          static_cast<unsigned long long>(master_.step()));
    service_.event(msg::SEVERITY_ERROR, "bad_command", arbiter_.nameOf(member) + ": " + wrong.data());
    memberLost(member, wrong.data());
    return proceed();
  }
  if (message.step() != master_.step()) return;
  const bool from_holder = member == arbiter_.holder() && !master_.hasCommand();
  const bool from_outgoing = member == arbiter_.outgoingAt(message.step()) && !master_.hasOutgoingCommand();
  if (!from_holder && !from_outgoing) return;

  JointVector effort;
  const char* ails = members_[static_cast<std::size_t>(member)].ails.data();
  const ReasonText objection = objectionTo(message, scenario_, ails, effort);
  const bool is_usable = objection.front() == '\0';
  if (!is_usable) {
    // It never reaches the integrator: the joints keep their torque for this step, and the next one is somebody else's.
    effort = arm_.holdingEffort(message.step());
    service_.event(msg::SEVERITY_ERROR, "bad_command", arbiter_.nameOf(member) + ": " + objection.data());
  }
  if (from_holder) {
    effort_ = effort;
    keeps_torque_ = !is_usable;
    hashes_.command = dds::chainHash(0, sample.payload);
    master_.commandArrived(message.step());
  } else {
    outgoing_effort_ = effort;
    hashes_.outgoing_command = dds::chainHash(0, sample.payload);
    master_.outgoingCommandArrived(message.step());
  }
  if (members_[static_cast<std::size_t>(member)].fails_when_commanded) {
    commandedAsPlanned(member);
  } else if (!is_usable) {
    memberLost(member, objection.data());
  }
  proceed();
}

void Plant::onBadInput(std::uint64_t step, const std::string& text) {
  if (bad_input_ || master_.isOver()) return;
  bad_input_ = {step, text};
  endAtBadInput();
}

/// At the sample's step: a reference comes a step early, and until then nothing is wrong. So the run ends with the same
/// bytes each time. A reset would wait for the sample.
void Plant::endAtBadInput() {
  if (bad_input_ && (reset_ || master_.step() >= bad_input_->step)) abort(bad_input_->text);
}

void Plant::onServiceStatus(const msg::ServiceStatus& status, const dds::RawSample& sample) {
  const std::string name = status.name().c_str();
  if (!service_.admission().speaksFor(sample.writer, name)) return;
  if (status.refused_topic().size() > 0) {
    const std::string text =
        badInputText(status.refused_topic().c_str(), status.refused_step(), status.refusal().c_str());
    if (!text.empty()) onBadInput(status.refused_step(), text + " (" + name + " refused it)");
  }
  const int member = memberCalled(name);
  if (status.state() == msg::SERVICE_READY) {
    if (status.plant() != service_.participant().self().prefix) {
      // Discovery may tell of the run's own plant only after everybody else has been matched.
      if (master_.phase() != SimPhase::kStarting) return;
      return service_.giveWay(name + " answers the steps of another plant");
    }
    waited_for_.erase(name);
    if (member == kBrake && status.role() == "controller") {
      newcomers_[name] = {dds::prefixOf(sample.writer), status.pid()};
      return;
    }
    if (member != kBrake) {
      // Another one of that name is heard only when this one has failed, of which word may come later.
      Member& one = members_[static_cast<std::size_t>(member)];
      const Speaker ready{dds::prefixOf(sample.writer), status.pid()};
      if (one.speaker.pid == 0) {
        one.speaker = ready;
        memberFound(member);
      } else if (one.is_lost) {
        becomes(one, ready);
      } else if (one.speaker.prefix != ready.prefix) {
        one.successor = ready;
      }
    }
    startWhenAllAreReady();
    if (member == kBrake) askAgain();  // a part that was started again has not seen the open step
  } else if (status.state() == msg::SERVICE_FAILED && !master_.isOver()) {
    newcomers_.erase(name);
    if (member == kBrake && status.role() == "controller") return;  // one that never stood by
    if (member == kBrake || master_.phase() == SimPhase::kStarting)
      return abort(name + " failed: " + status.text().c_str());
    Member& one = members_[static_cast<std::size_t>(member)];
    if (one.speaker.pid != status.pid()) return;  // not the one that speaks for it
    memberLost(member, status.text().c_str());
    if (one.successor.pid != 0) becomes(one, std::exchange(one.successor, {}));
    proceed();
  }
}

/// Another process from here on. It returns when it has computed a step, and with that has said what its law is.
void Plant::becomes(Member& member, const Speaker& speaker) {
  member.is_new = member.speaker.prefix != speaker.prefix;
  member.speaker = speaker;
}

/// Whoever failed and lives goes on computing: it is eligible again once it has answered a later step. As holder it
/// never returns by itself.
void Plant::onControllerStatus(const msg::ControllerStatus& status, const dds::RawSample& sample) {
  const int member = memberCalled(status.name().c_str());
  if (speaksFor(member, sample)) {
    const bool ails = status.state() == msg::CONTROLLER_FAILED;
    write(members_[static_cast<std::size_t>(member)].ails, "%s", ails ? status.text().c_str() : "");
  }
  const bool stands_by = status.state() == msg::CONTROLLER_STANDBY || status.state() == msg::CONTROLLER_COLD;
  if (master_.isOver() || !stands_by) return;
  if (member == kBrake) return newcomerStandsBy(status, sample);
  if (!speaksFor(member, sample)) return;
  if (const LawInfo* law = lawCalled(status.law().c_str())) arbiter_.memberChanged(member, law->requires_contact);
  const Member& one = members_[static_cast<std::size_t>(member)];
  const bool is_past_it = one.is_new || status.step() > arbiter_.failedAt(member);
  if (one.is_lost && arbiter_.hasFailed(member) && is_past_it) memberFound(member);
}

/// A controller that the scenario did not have computes along: from now on the baton may go to it.
void Plant::newcomerStandsBy(const msg::ControllerStatus& status, const dds::RawSample& sample) {
  const auto found = newcomers_.find(std::string_view(status.name().c_str()));
  const LawInfo* law = lawCalled(status.law().c_str());
  if (found == newcomers_.end() || found->second.prefix != dds::prefixOf(sample.writer) || law == nullptr) return;
  if (arbiter_.members().size() == msg::MAX_CONTROLLERS) return;  // the supervisor starts no more than that
  arbiter_.memberJoined({found->first, law->requires_contact});
  members_.emplace_back().speaker = found->second;
  newcomers_.erase(found);
  service_.event(msg::SEVERITY_INFO, "joined", arbiter_.members().back().name + " stands by");
  publishBaton();
}

void Plant::onSimRequest(const msg::SimRequest& request) {
  if (service_.isOver()) return;
  msg::SimReply reply;
  reply.request_id(request.request_id());
  const auto refuse = [&](const std::string& reason) { reply.reason(reason); };
  const std::uint64_t step = master_.step();
  if (master_.isOver()) {
    refuse("the run is over");
  } else if (master_.phase() == SimPhase::kStarting) {
    refuse("the run has not started; `baton down` ends it");
  } else {
    switch (request.action()) {
      case msg::SIM_PAUSE:
        if (request.at_step() == 0) {
          master_.pause();
          timing_.interrupted();
          reply.accepted(true);
        } else if (master_.pauseAt(request.at_step())) {
          reply.accepted(true);
        } else {
          refuse("expected a step after " + std::to_string(step) + " and before the end of the run");
        }
        break;
      case msg::SIM_RESUME:
        master_.resume();
        pacer_.anchor(step, steadyNow());
        reply.accepted(true);
        break;
      case msg::SIM_STEP:
        if (request.steps() == 0) {
          refuse("expected at least one step");
        } else {
          master_.stepBy(request.steps());
          pacer_.anchor(step, steadyNow());
          reply.accepted(true);
        }
        break;
      case msg::SIM_RATE:
        if (request.rate() != 0.0 && !(request.rate() >= kMinRate && request.rate() <= kMaxRate)) {
          refuse("expected a rate from 1e-7 to 1000, or 0 for as fast as possible");
        } else if (isRealtime()) {
          refuse("a realtime run has rate 1");
        } else {
          pacer_.setRate(request.rate(), step, steadyNow());
          reply.accepted(true);
        }
        break;
      case msg::SIM_RESET:
        if (checkpoints_.firstStep() > 0) {
          refuse("a branch begins in the middle of a run: end it and branch again");
        } else if (reset_) {
          refuse("a reset is under way");
        } else {
          return askForReset(request.request_id());  // which answers when it is done
        }
        break;
      case msg::SIM_STOP:
        if (request.at_step() == 0 || stopAt(request.at_step())) {
          reply.accepted(true);
        } else {
          refuse("expected a step after " + std::to_string(step) + " and not after the end of the run");
        }
        break;
    }
  }
  reply.step(step);
  publish(status());  // before the reply: whoever has that and looks sees what it did
  reply_out_.write(reply);
  if (request.action() == msg::SIM_STOP && reply.accepted() && request.at_step() == 0) {
    end_reason_ = "stopped by request";
    decideEnd(step);
    master_.finish();
    return finish();
  }
  proceed();
  armTimer();
  publish(status());
}

}  // namespace baton
