/// What a recording says in plain text of how its run went, beside the messages: what was noticed, and the parameters
/// that the controllers ran with in the end.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "msg/parameter.h"
#include "msg/service.h"

namespace baton {

class RunNotes {
 public:
  static constexpr std::size_t kMaxEvents = 10'000;  // the messages have them all

  void add(const msg::Event& event);
  void add(const msg::ParameterStatus& status) { parameters_[status.name().c_str()] = status; }

  /// JSON: {"events": [{step, time_ns, severity, service, kind, text}], "not_listed": n}.
  [[nodiscard]] std::string events() const;
  /// JSON: {controller: {"law": ..., "parameters": {name: number, list or word}}}.
  [[nodiscard]] std::string parameters() const;

 private:
  std::vector<msg::Event> events_;
  std::size_t not_listed_ = 0;
  std::map<std::string, msg::ParameterStatus> parameters_;
};

}  // namespace baton
