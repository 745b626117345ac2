#include "summary.hpp"

#include <spdlog/fmt/fmt.h>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "runtime/json.hpp"

namespace baton {
namespace {

double messagesPerSecond(const ReplayResult& result) {
  return result.elapsed_s > 0.0 ? static_cast<double>(result.messages) / result.elapsed_s : 0.0;
}

double inMicroseconds(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-3; }

std::string endText(const ReplayResult& result) {
  if (result.was_interrupted) return "interrupted";
  return result.was_stopped ? "stopped" : "replayed";
}

std::string latenessText(const ReplayResult& result, const ReplayOptions& options) {
  const Histogram& lateness = result.lateness_ns;
  return fmt::format("lateness     p50 {:.1f} us, p99 {:.1f} us, max {:.1f} us, {} above {:g} us\n",
                     inMicroseconds(lateness.quantile(0.5)), inMicroseconds(lateness.quantile(0.99)),
                     inMicroseconds(lateness.max()), counted(result.overdue, "message"), options.overdue_us);
}

}  // namespace

std::string summaryText(const ReplayResult& result, const ReplayOptions& options) {
  const std::string pass = counted(result.total, "message");
  std::string text =
      fmt::format("{:<13}{}, {}, {}\n", endText(result),
                  result.passes > 1 ? fmt::format("{} in {} passes of {}", result.messages, result.passes, pass)
                                    : fmt::format("{} of {}", result.messages, pass),
                  counted(result.writers, "writer"), counted(result.topics, "topic"));
  text += fmt::format("duration     {:.3f} s for {:.3f} recorded s, {:.0f} messages/s\n", result.elapsed_s,
                      result.recorded_s, messagesPerSecond(result));
  if (result.lateness_ns.count() > 0) text += latenessText(result, options);
  for (const std::string& problem : result.problems) text += "problem      " + escaped(problem) + "\n";
  for (const std::string& note : result.notes) text += "note         " + escaped(note) + "\n";
  text.pop_back();
  return text;
}

std::string jsonText(const ReplayResult& result, const ReplayOptions& options) {
  nlohmann::ordered_json json{{"file", options.file},
                              {"domain", options.domain},
                              {"cell", options.cell},
                              {"run", options.run},
                              {"interrupted", result.was_interrupted},
                              {"stopped", result.was_stopped},
                              {"messages", result.messages},
                              {"total", result.total},
                              {"passes", result.passes},
                              {"writers", result.writers},
                              {"topics", result.topics},
                              {"rate", nullptr},
                              {"recorded_s", result.recorded_s},
                              {"elapsed_s", result.elapsed_s},
                              {"messages_per_s", messagesPerSecond(result)},
                              {"lateness_us", nullptr},
                              {"overdue", nullptr},
                              {"overdue_us", options.overdue_us},
                              {"problems", result.problems},
                              {"notes", result.notes}};
  if (options.rate > 0.0) json["rate"] = options.rate;
  if (const Histogram& lateness = result.lateness_ns; lateness.count() > 0) {
    json["lateness_us"] = {{"p50", inMicroseconds(lateness.quantile(0.5))},
                           {"p99", inMicroseconds(lateness.quantile(0.99))},
                           {"max", inMicroseconds(lateness.max())}};
    json["overdue"] = result.overdue;
  }
  return toText(json);
}

}  // namespace baton
