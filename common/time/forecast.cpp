#include "time/forecast.hpp"

#include <cstdarg>
#include <cstdio>

namespace baton {

void write(ReasonText& reason, const char* format, ...) noexcept {
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(reason.data(), reason.size(), format, arguments);
  va_end(arguments);
}

Verdict judge(const ArbiterMember& incoming, const Forecast& forecast, const ForecastStep& step, double max_effort_step,
              bool force) noexcept {
  Verdict verdict;
  const char* name = incoming.name.c_str();
  if (!forecast.is_ready) {
    write(verdict.objection, "%s is not ready: %.120s", name, forecast.not_ready.data());
    return verdict;
  }
  if (forecast.effort.size() != step.holder_effort.size() || !forecast.effort.allFinite()) {
    write(verdict.objection, "%s forecasts %d efforts, not %d finite ones", name,
          static_cast<int>(forecast.effort.size()), static_cast<int>(step.holder_effort.size()));
    return verdict;
  }
  verdict.effort_step = forecast.effort - step.holder_effort;
  if (incoming.requires_contact && !step.in_contact) {
    write(verdict.objection, "%s controls force and the tip touches nothing", name);
    return verdict;
  }
  Eigen::Index joint = 0;
  const double jump = verdict.effort_step.cwiseAbs().maxCoeff(&joint);
  if (jump > max_effort_step && !force) {
    write(verdict.objection, "%s would change joint %d by %.4g, above the limit of %.4g; force it to insist", name,
          static_cast<int>(joint) + 1, jump, max_effort_step);
  }
  return verdict;
}

}  // namespace baton
