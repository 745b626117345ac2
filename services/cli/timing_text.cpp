#include "timing_text.hpp"

#include <array>
#include <cstdio>

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

/// "81.2 us (p50), 190.3 (p99), 1203.0 at most"
std::string spreadText(const Json& spread) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "%.1f us (p50), %.1f (p99), %.1f at most", spread.at("p50").get<double>(),
                spread.at("p99").get<double>(), spread.at("max").get<double>());
  return text.data();
}

}  // namespace

std::string timingText(const Json& timing) {
  const Json& period = timing.at("period_us");
  const Json& jitter = timing.at("jitter_us");
  const Json& age = timing.at("command_age_steps");
  std::string text;
  if (!period.is_null()) text = "a step takes " + spreadText(period);
  if (!jitter.is_null() && !age.is_null()) {
    text += (text.empty() ? "" : "; ") + ("it ends late by " + spreadText(jitter)) + ", with a torque " +
            std::to_string(age.at("max").get<std::uint64_t>()) + " steps old at most";
  }
  return text;
}

}  // namespace baton
