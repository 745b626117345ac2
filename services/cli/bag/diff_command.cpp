#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <memory>
#include <string>

#include "bag/recording_diff.hpp"
#include "bag/subcommands.hpp"
#include "base/text.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

std::string nameOf(const StreamKey& key) { return key.second.empty() ? key.first : key.first + " of " + key.second; }

std::string textOf(const Position& at) {
  std::string text = at.step ? "step " + std::to_string(*at.step) : "message " + std::to_string(at.index + 1);
  if (at.step && at.index > 0) text += " (message " + std::to_string(at.index + 1) + " of it)";
  if (at.take > 0) text += " of take " + std::to_string(at.take + 1);
  return text;
}

std::string textOf(const FirstDifference& first) {
  const FieldDifference& what = first.what;
  return textOf(first.at) + (what.field.empty() ? "" : ", " + what.field) + ": " + what.a + " | " + what.b;
}

/// Which take of each recording is compared; empty where neither was reset.
std::string takesText(const RecordingDiff& diff) {
  const auto [a, b] = diff.resets_before;
  if (a == 0 && b == 0) return "";
  const auto one = [](std::uint32_t resets) {
    return resets == 0 ? "the only one" : fmt::format("the last of {}, after a reset", resets + 1);
  };
  return fmt::format("takes       A: {}; B: {}\n", one(a), one(b));
}

void printText(const DiffRequest& request, const RecordingDiff& diff) {
  std::size_t topic_width = 5, service_width = 7;
  for (const auto& [key, stream] : diff.streams) {
    topic_width = std::max(topic_width, escaped(key.first).size());
    service_width = std::max(service_width, escaped(key.second).size());
  }
  const auto first = diff.firstDifferent();
  sayf("{}: A {}, B {}\n", diff.isSame() ? "same" : "different", request.a.string(), request.b.string());
  sayText(takesText(diff));
  if (first) {
    sayf("first       {}, {}\n", nameOf(*first), textOf(*diff.streams.at(*first).first));
  }
  if (const auto later = diff.laterBegin()) {
    sayf("begins      A at step {}, B at step {}: --from-step {} leaves out what one alone has\n", *diff.first_step[0],
         *diff.first_step[1], *later);
  }
  if (!diff.left_out.empty()) {
    sayf("left out    {}\n", fmt::format("{}", fmt::join(diff.left_out, ", ")));
  }
  sayf("\n{:<{}}  {:<{}}  {:>9}  {:>9}  {:>9}  {:>9}  first difference, A | B\n", "topic", topic_width, "service",
       service_width, "compared", "different", "only in A", "only in B");
  for (const auto& [key, stream] : diff.streams) {
    sayf("{:<{}}  {:<{}}  {:>9}  {:>9}  {:>9}  {:>9}  {}\n", key.first, topic_width, key.second, service_width,
         stream.compared, stream.different, stream.only_a, stream.only_b, stream.first ? textOf(*stream.first) : "");
  }
}

nlohmann::ordered_json toJson(const DiffRequest& request, const RecordingDiff& diff) {
  nlohmann::ordered_json streams = nlohmann::ordered_json::array();
  for (const auto& [key, stream] : diff.streams) {
    nlohmann::ordered_json row{{"topic", key.first},
                               {"service", key.second},
                               {"compared", stream.compared},
                               {"different", stream.different},
                               {"only_a", stream.only_a},
                               {"only_b", stream.only_b},
                               {"first", nullptr}};
    if (stream.first) {
      const Position& at = stream.first->at;
      row["first"] = {{"take", at.take},           {"step", nullptr},
                      {"index", at.index},         {"field", stream.first->what.field},
                      {"a", stream.first->what.a}, {"b", stream.first->what.b}};
      if (at.step) row["first"]["step"] = *at.step;
    }
    streams.push_back(row);
  }
  nlohmann::ordered_json json{{"a", request.a.string()},   {"b", request.b.string()},
                              {"same", diff.isSame()},     {"first", nullptr},
                              {"left_out", diff.left_out}, {"resets_before", diff.resets_before},
                              {"first_step", nullptr},     {"streams", streams}};
  const auto& [a, b] = diff.first_step;
  if (a && b) json["first_step"] = {*a, *b};
  if (const auto first = diff.firstDifferent()) json["first"] = {{"topic", first->first}, {"service", first->second}};
  return json;
}

/// The command line.
struct DiffWish {
  std::string a, b;  // files or folders
  bool with_parts = false;
  DiffRequest request;
  bool json = false;
};

ExitCode diff(DiffWish& wish) {
  DiffRequest& request = wish.request;
  ExitCode holes = ExitCode::kOk;
  request.a = findRecording({.given = {wish.a}, .with_parts = wish.with_parts}, holes);
  request.b = findRecording({.given = {wish.b}, .with_parts = wish.with_parts}, holes);
  RecordingDiff found;
  {
    ProgressLine line;
    found = diffRecordings(request, [&](double part) { line.show("comparing " + progressBar(part)); });
  }
  for (const std::string& warning : found.warnings) sayWarning(warning);
  if (wish.json) {
    sayText(toText(toJson(request, found)) + '\n');
  } else {
    printText(request, found);
  }
  return found.isSame() ? holes : ExitCode::kFailed;
}

}  // namespace

void addBagDiff(CLI::App& bag, ExitCode& exit_code) {
  const auto wish = std::make_shared<DiffWish>();
  DiffRequest* request = &wish->request;
  CLI::App* command = bag.add_subcommand("diff", "whether two recordings are of the same, sample by sample");
  command->footer(
      "Samples are paired by topic, service and step; by their order where messages have no step. Unless --topics\n"
      "names others, the topics of the control loop are compared: plant_state, contact, reference, joint_command\n"
      "and shadow_command. Two runs of a scenario in lockstep are the same in these, while status, requests and\n"
      "events tell of processes and clocks. In recordings without any of them, all but *_status are compared. Of a\n"
      "run that was reset only the last take is compared, as by `bag hash`, metrics, shadow, whatif and rerun;\n"
      "--all-takes compares the takes before it as well.\n"
      "Without --tolerance and --ignore bytes are compared, with them values; with --tolerance members called\n"
      "*_hash are left out. A field is named without indices, as position or reference.position, and stands for all\n"
      "within it. Memory: a chunk of each recording, those that overlap it in time, and the samples that wait for\n"
      "their counterpart.\n"
      "Exit codes: 0 the same, 1 different, 2 wrong input or not a recording, 3 cannot be opened.");
  command->add_option("a", wish->a, kOneRecordingText)->required();
  command->add_option("b", wish->b, "another one")->required();
  addParts(*command, wish->with_parts);
  command->add_option("--topics", request->topics, "only these topics: a,b,c")->delimiter(',')->allow_extra_args(false);
  command->add_option("--ignore", request->ignored, "topics, topic.field or field, not to compare")->delimiter(',');
  command->add_option("--tolerance", request->tolerances,
                      "how far numbers may be apart, in their unit: everywhere, or as field=1e-9,topic.field=1e-9");
  command->add_option("--from-step", request->from_step, "of messages that have a step only those from this one on");
  command->add_option("--to-step", request->to_step, "and up to this one");
  command->add_flag("--all-takes", request->all_takes, "the takes before a reset too");
  command->add_flag("--json", wish->json, "as a JSON object");
  command->callback([wish, &exit_code] { exit_code = diff(*wish); });
}

}  // namespace baton
