#include "parameter_changes.hpp"

#include "base/error.hpp"
#include "messages/parameters.hpp"
#include "parameter_report.hpp"

namespace baton {
namespace {

constexpr const char* kOver = "the run is over";

}  // namespace

ParameterChanges::ParameterChanges(Service& service, const ControllerConfig& config, RunningLaw& law,
                                   std::uint64_t first_step)
    : service_(service),
      config_(config),
      info_(law.info()),
      first_step_(first_step),
      schedule_(law.parameters()),
      next_step_(first_step),
      status_out_(service.output(dds::topics::kParameterStatus)),
      reply_out_(service.output(dds::topics::kParameterReply, withRecorder({}, service.scenario()))),
      decision_out_(service.output(dds::topics::kDecision, withRecorder({}, service.scenario()))),
      report_(parameterReport(config)) {
  service.input(dds::topics::kParameterRequest, {},
                [this](const msg::ParameterRequest& request, const dds::RawSample& sample) {
                  if (!service_.isFromBefore(sample)) onRequest(request);
                });
}

void ParameterChanges::publish() {
  fill(info_, schedule_.values(), report_);
  status_out_.write(report_);
}

void ParameterChanges::rewind() {
  next_step_ = first_step_;
  publish();
}

void ParameterChanges::onRequest(const msg::ParameterRequest& request) {
  if (config_.name != request.controller().c_str()) return;
  if (service_.isOver()) return refuse(request, kOver);
  const std::uint64_t at_step = request.at_step();
  if (at_step != 0 && at_step < next_step_) {
    return refuse(request, "step " + std::to_string(at_step) + " has gone by: expected " + std::to_string(next_step_) +
                               " or a later one, or none for as soon as possible");
  }
  if (const std::uint64_t end = service_.scenario().end_step; end > 0 && at_step >= end) {
    return refuse(request, "expected a step before the end of the run, " + std::to_string(end) + ", found " +
                               std::to_string(at_step));
  }
  boost::asio::post(service_.executor(), [this, request, take = service_.take()] { decide(request, take); });
}

void ParameterChanges::decide(const msg::ParameterRequest& request, std::uint32_t take) {
  ParameterSchedule::Draft draft;  // takes along what is replaced, to be destroyed when the loop may go on
  std::unique_lock lock(service_.mutex());
  try {
    const ParameterChange asked{request.at_step(), fromMessages(request.values()), false};
    while (!service_.isOver()) {
      if (take != service_.take()) return refuse(request, "the run was reset");
      draft = schedule_.draft(asked, next_step_);
      lock.unlock();
      try {
        schedule_.make(draft);
      } catch (const UsageError&) {
        lock.lock();
        throw;
      }
      lock.lock();
      if (take != service_.take()) continue;
      if (const auto change = schedule_.accept(draft, next_step_)) return accept(request, *change);
    }
    refuse(request, kOver);
  } catch (const UsageError& error) {
    refuse(request, error.what());
  }
}

void ParameterChanges::accept(const msg::ParameterRequest& request, const ParameterChange& change) {
  msg::Decision decision;
  decision.step(next_step_ > first_step_ ? next_step_ - 1 : first_step_);
  decision.take(service_.take());
  decision.cause(msg::DECISION_PARAMETERS);
  decision.controller(config_.name);
  decision.at_step(change.at_step);
  decision.values() = toMessages(change.set);
  decision_out_.write(decision);
  msg::ParameterReply reply;
  reply.request_id(request.request_id());
  reply.controller(config_.name);
  reply.accepted(true);
  reply.at_step(change.at_step);
  reply_out_.write(reply);
  service_.event(msg::SEVERITY_INFO, "parameters",
                 config_.name + ": " + toText(change.set) + " from step " + std::to_string(change.at_step) + " on");
}

void ParameterChanges::refuse(const msg::ParameterRequest& request, const std::string& reason) {
  msg::ParameterReply reply;
  reply.request_id(request.request_id());
  reply.controller(config_.name);
  reply.at_step(request.at_step());
  reply.reason(reason);
  reply_out_.write(reply);
  service_.event(msg::SEVERITY_WARNING, "parameters_refused", config_.name + ": " + reason);
}

}  // namespace baton
