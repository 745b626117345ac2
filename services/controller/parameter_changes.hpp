/// The parameters a controller runs with, and the law that is made with them: what operators ask for, what is in force,
/// and what others hear of both. Which change takes place at which step is the schedule's business.
///
/// Threads. Requests come on DDS's receive thread, under the service's lock. Laws are made on the executor without it,
/// for that takes longer than a step may wait; then the change is taken in, under the lock again.
#pragma once

#include <cstdint>

#include "control/parameter_schedule.hpp"
#include "runtime/service.hpp"

namespace baton {

class ParameterChanges {
 public:
  /// @param first_step  the step at which the run begins.
  ParameterChanges(Service& service, const ControllerConfig& config, const LawInfo& info, std::uint64_t first_step);

  [[nodiscard]] Law& law() noexcept { return schedule_.law(); }

  /// `step` is about to be computed. True when other values are in force from here on; publish() tells them, for which
  /// there is time once the step is answered. Both allocate nothing.
  bool advance(std::uint64_t step);
  void publish();

  /// See ParameterSchedule.
  void archive(StateArchive& state) { schedule_.archive(state, first_step_); }
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
  ParameterSchedule schedule_;
  std::uint64_t next_step_;  // the first one that is not computed yet

  dds::Writer<msg::ParameterStatus>& status_out_;
  dds::Writer<msg::ParameterReply>& reply_out_;
  dds::Writer<msg::Decision>& decision_out_;
  msg::ParameterStatus report_;
};

}  // namespace baton
