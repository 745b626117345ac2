#include "run_notes.hpp"

#include "runtime/json.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;

const char* nameOf(msg::Severity severity) {
  switch (severity) {
    case msg::SEVERITY_INFO: return "info";
    case msg::SEVERITY_WARNING: return "warning";
    case msg::SEVERITY_ERROR: return "error";
  }
  return "?";
}

Json valueOf(const msg::Parameter& parameter) {
  if (parameter.numbers().empty()) return parameter.word().c_str();
  if (parameter.numbers().size() == 1) return parameter.numbers().front();
  return parameter.numbers();
}

}  // namespace

void RunNotes::add(const msg::Event& event) {
  if (events_.size() < kMaxEvents) {
    events_.push_back(event);
  } else {
    ++not_listed_;
  }
}

std::string RunNotes::events() const {
  Json list = Json::array();
  for (const msg::Event& event : events_) {
    list.push_back({{"step", event.step()},
                    {"time_ns", event.time_ns()},
                    {"severity", nameOf(event.severity())},
                    {"service", event.service().c_str()},
                    {"kind", event.kind().c_str()},
                    {"text", event.text().c_str()}});
  }
  return toText(Json{{"events", list}, {"not_listed", not_listed_}});
}

std::string RunNotes::parameters() const {
  Json all = Json::object();
  for (const auto& [name, status] : parameters_) {
    Json values = Json::object();
    for (const msg::Parameter& parameter : status.parameters()) values[parameter.name().c_str()] = valueOf(parameter);
    all[name] = {{"law", status.law().c_str()}, {"parameters", values}};
  }
  return toText(all);
}

}  // namespace baton
