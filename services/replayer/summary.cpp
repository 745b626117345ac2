#include "summary.hpp"

#include <spdlog/fmt/fmt.h>

#include "runtime/json.hpp"

namespace baton {
namespace {

double messagesPerSecond(const ReplayResult& result) {
  return result.elapsed_s > 0.0 ? static_cast<double>(result.messages) / result.elapsed_s : 0.0;
}

}  // namespace

std::string summaryText(const ReplayResult& result, const ReplayOptions& options) {
  std::string text = fmt::format("{}  {} of {} messages, {} writers, {} topics\n",
                                 result.was_interrupted ? "interrupted" : "replayed   ", result.messages, result.total,
                                 result.writers, result.topics);
  text += fmt::format("duration     {:.3f} s for {:.3f} recorded s, {:.0f} messages/s\n", result.elapsed_s,
                      result.recorded_s, messagesPerSecond(result));
  if (options.rate > 0.0) {
    text += fmt::format("lateness     p50 {:.1f} us, p99 {:.1f} us, max {:.1f} us\n", result.lateness.p50_us,
                        result.lateness.p99_us, result.lateness.max_us);
  }
  for (const std::string& problem : result.problems) text += "problem      " + problem + "\n";
  text.pop_back();
  return text;
}

std::string jsonText(const ReplayResult& result, const ReplayOptions& options) {
  nlohmann::ordered_json json{{"file", options.file},
                              {"domain", options.domain},
                              {"cell", options.cell},
                              {"run", options.run},
                              {"interrupted", result.was_interrupted},
                              {"messages", result.messages},
                              {"total", result.total},
                              {"writers", result.writers},
                              {"topics", result.topics},
                              {"rate", nullptr},
                              {"recorded_s", result.recorded_s},
                              {"elapsed_s", result.elapsed_s},
                              {"messages_per_s", messagesPerSecond(result)},
                              {"lateness_us", nullptr},
                              {"problems", result.problems}};
  if (options.rate > 0.0) {
    json["rate"] = options.rate;
    json["lateness_us"] = {
        {"p50", result.lateness.p50_us}, {"p99", result.lateness.p99_us}, {"max", result.lateness.max_us}};
  }
  return toText(json);
}

}  // namespace baton
