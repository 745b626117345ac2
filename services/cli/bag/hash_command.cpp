#include <spdlog/fmt/fmt.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bag/run_hash.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "base/plural.hpp"
#include "dds/topics.hpp"
#include "report/recording.hpp"
#include "runtime/json.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

struct HashRequest {
  std::string recording;  // a file or a folder
  std::string other;      // to compare with
  bool with_parts = false;
  bool json = false;
};

/// Of a recording that was made without one of the loop's topics nothing can be said.
HashedRun hashWholeRun(const mcap::FileList& file, ExitCode& exit_code) {
  const mcap::JoinedReader reader(file);
  warnIfIncomplete(file.string(), reader.info(), exit_code);
  for (const char* topic : {dds::topics::kJointCommand.name, dds::topics::kContact.name}) {
    expectNotLeftOut(reader, topic, file);
  }
  return hashRun(reader, file);
}

/// Of steps that are not there nothing can be said but that.
std::string brokenText(const HashedRun& run, std::uint64_t broken) {
  const std::uint64_t next = run.steps.upper_bound(broken)->first;
  if (next == broken + 1) return fmt::format("the payloads of step {} do not give the hash after it", broken);
  return fmt::format("steps {} to {} are missing: what was before does not give the hash after them", broken + 1,
                     next - 1);
}

/// Prints the hash and says whether the payloads give it.
ExitCode hash(const HashRequest& request) {
  ExitCode holes = ExitCode::kOk;
  const mcap::FileList file = findRecording({.given = {request.recording}, .with_parts = request.with_parts}, holes);
  const HashedRun run = hashWholeRun(file, holes);
  const std::optional<std::uint64_t> broken = run.firstBroken();
  nlohmann::ordered_json json{{"file", file.string()},
                              {"hash", std::to_string(run.hash())},
                              {"first_step", run.steps.begin()->first},
                              {"last_step", run.steps.rbegin()->first},
                              {"payloads_agree", !broken}};
  if (broken) json["first_broken_step"] = *broken;
  std::string verdict = broken ? brokenText(run, *broken) : "the recorded payloads give it, step by step";
  bool is_good = !broken;
  if (!request.other.empty()) {
    const mcap::FileList other_file =
        findRecording({.given = {request.other}, .with_parts = request.with_parts}, holes);
    const HashedRun other = hashWholeRun(other_file, holes);
    const Comparison comparison = compare(run, other);
    const std::optional<Parting>& parting = comparison.parting;
    const bool is_same = !parting && comparison.steps > 0 && !other.firstBroken();
    json["same_as"] = {{"file", other_file.string()}, {"same", is_same}, {"steps_compared", comparison.steps}};
    if (parting) {
      json["same_as"]["first_different_step"] = parting->step;
      json["same_as"]["topic"] = parting->topic;
      verdict += "\ndiffers from " + other_file.string() + " first at step " + std::to_string(parting->step) + " in " +
                 parting->topic;
    } else {
      verdict += "\n" +
                 (comparison.steps == 0 ? "no step in common with " + other_file.string()
                                        : "the same as " + other_file.string() + " in the " +
                                              counted(comparison.steps, "step") + " that both have") +
                 (other.firstBroken() ? ", whose payloads do not give its own hash" : "");
    }
    is_good = is_good && is_same;
  }
  if (request.json) {
    sayText(toText(json) + '\n');
  } else {
    say("%s of steps %s to %s\n%s\n", json["hash"].get<std::string>().c_str(), json["first_step"].dump().c_str(),
        json["last_step"].dump().c_str(), verdict.c_str());
  }
  return is_good ? holes : ExitCode::kFailed;
}

}  // namespace

void addBagHash(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<HashRequest>();
  CLI::App* command =
      bag.add_subcommand("hash", "the hash of a recorded run, computed again from its payloads; two files: compared");
  command->footer(
      "It is made of the topics plant_state, contact and joint_command.\n"
      "Exit codes: 0 the payloads give the hash that the run had, and the other file has the same; 1 otherwise,\n"
      "with the first step, or a recording is cut; 2 not the recording of a run, or one without a topic of these; 3 "
      "cannot be opened.");
  command->add_option("file", request->recording, kOneRecordingText)->required();
  command->add_option("other", request->other, "another one, to compare step by step");
  addParts(*command, request->with_parts);
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] { exit_code = hash(*request); });
}

}  // namespace baton
