/// The parameters a controller runs with: what operators ask for, what is in force, and what others hear of both. Which
/// change takes place at which step is the schedule's business.
///
/// Threads. Requests come on DDS's receive thread, under the service's lock. Laws are made on the executor without it,
/// for that takes longer than a step may wait; then the change is taken in, under the lock again.
#pragma once

#include <cstdint>

#include "runtime/running_law.hpp"
#include "runtime/service.hpp"

namespace baton {

class ParameterChanges {
 public:
  /// @param first_step  the step at which the run begins.
  ParameterChanges(Service& service, const ControllerConfig& config, RunningLaw& law, std::uint64_t first_step);

  /// `step` is about to be computed.
  void at(std::uint64_t step) noexcept { next_step_ = step + 1; }
  /// Tells what is in force.
  void publish();
  /// The law is back at the start of the run.
  void rewind();

 private:
  void onRequest(const msg::ParameterRequest& request);
  void decide(const msg::ParameterRequest& request, std::uint32_t take);
  void accept(const msg::ParameterRequest& request, const ParameterChange& change);
  void refuse(const msg::ParameterRequest& request, const std::string& reason);

  Service& service_;
  const ControllerConfig& config_;
  const LawInfo& info_;
  const std::uint64_t first_step_;
  ParameterSchedule& schedule_;
  std::uint64_t next_step_;  // the first one that is not computed yet

  dds::Writer<msg::ParameterStatus>& status_out_;
  dds::Writer<msg::ParameterReply>& reply_out_;
  dds::Writer<msg::Decision>& decision_out_;
  msg::ParameterStatus report_;
};

}  // namespace baton
