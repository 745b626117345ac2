#include "traffic/result.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "base/plural.hpp"
#include "base/text.hpp"
#include "runtime/json.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

std::uint64_t lostIn(const TrafficResult& result) {
  std::uint64_t lost = 0;
  for (const TrafficResult::Topic& topic : result.topics) lost += topic.lost;
  return lost;
}

std::string placeOf(const TrafficOptions& options) {
  return options.interfaces.empty() ? "all interfaces" : fmt::format("{}", fmt::join(options.interfaces, ", "));
}

std::string tableOf(const std::vector<TrafficResult::Topic>& topics) {
  std::size_t name_width = 5, type_width = 4;
  for (const TrafficResult::Topic& topic : topics) {
    name_width = std::max(name_width, escaped(topic.name).size());
    type_width = std::max(type_width, escaped(topic.type).size());
  }
  std::string text = fmt::format("\n{:<{}}  {:<{}}  {:>9}  {:>6}  {:>7}", "topic", name_width, "type", type_width,
                                 "messages", "lost", "writers");
  for (const TrafficResult::Topic& topic : topics) {
    text += fmt::format("\n{:<{}}  {:<{}}  {:>9}  {:>6}  {:>7}", escaped(topic.name), name_width, escaped(topic.type),
                        type_width, topic.messages, topic.lost, topic.writers);
  }
  return text;
}

}  // namespace

ExitCode exitCodeOf(const TrafficResult& result, const TrafficOptions& options) {
  const bool was_to_end = options.duration_s.has_value() || options.max_messages > 0;
  if (result.end == TrafficEnd::kSignal && was_to_end) return ExitCode::kInterrupted;
  return result.is_complete ? ExitCode::kOk : ExitCode::kFailed;
}

std::string textOf(const TrafficResult& result, const TrafficOptions& options) {
  std::string text = fmt::format("{}: {}\n", fmt::join(result.files, ", "), result.summary);
  text += fmt::format("recorded    {:.1f} s of domain {} on {}\n", result.seconds, options.domain, placeOf(options));
  text += fmt::format("messages    {} of {}, {} lost\n", result.messages, counted(result.topics.size(), "topic"),
                      lostIn(result));
  text += fmt::format("size        {:.2f} MB", static_cast<double>(result.bytes) * 1e-6);
  constexpr std::size_t kMostProblems = 20;
  for (std::size_t i = 0; i < std::min(result.problems.size(), kMostProblems); ++i) {
    text += fmt::format("\nproblem     {}", escaped(result.problems[i]));
  }
  if (result.problems.size() > kMostProblems) {
    text += fmt::format("\nproblem     {} more, see --json", result.problems.size() - kMostProblems);
  }
  if (!result.topics.empty()) text += "\n" + tableOf(result.topics);
  return text;
}

std::string jsonOf(const TrafficResult& result, const TrafficOptions& options) {
  Json topics = Json::array(), losses = Json::array();
  for (const TrafficResult::Topic& topic : result.topics) {
    topics.push_back({{"topic", topic.name},
                      {"type", topic.type},
                      {"messages", topic.messages},
                      {"lost", topic.lost},
                      {"writers", topic.writers}});
  }
  for (const TrafficResult::Loss& loss : result.losses) {
    losses.push_back({{"topic", loss.topic}, {"writer", loss.writer}, {"service", loss.service}, {"lost", loss.lost}});
  }
  return toText(Json{{"files", result.files},
                     {"complete", result.is_complete},
                     {"summary", result.summary},
                     {"ended", result.ended},
                     {"exit_code", static_cast<int>(exitCodeOf(result, options))},
                     {"domain", options.domain},
                     {"interfaces", options.interfaces},
                     {"duration_s", result.seconds},
                     {"messages", result.messages},
                     {"size_B", result.bytes},
                     {"lost", lostIn(result)},
                     {"topics", topics},
                     {"losses", losses},
                     {"problems", result.problems},
                     {"left_out", result.left_out},
                     {"unmatched", result.unmatched}});
}

}  // namespace baton
