#include "record_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <memory>
#include <string>

#include "base/text.hpp"
#include "become.hpp"
#include "cell_target.hpp"
#include "messages/state_names.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/say.hpp"
#include "runtime/service_options.hpp"

namespace baton {
namespace {
using Json = nlohmann::ordered_json;
using ull = unsigned long long;

constexpr std::chrono::minutes kFilePatience{2};  // for one that is written and waits for its disk

struct RecordArguments {
  CellTarget target;
  std::string out;
};

CellClient clientOf(const CellTarget& target) { return CellClient(CellClient::find(target.domain, target.cell)); }

double mega(std::uint64_t bytes) { return static_cast<double>(bytes) * 1e-6; }

void requireRecorder(const CellClient& client) {
  if (!client.info().recording.empty()) return;
  throw UnavailableError("run " + client.info().run +
                         " has no recorder: start it without --no-recording; with --record-later it waits for "
                         "`baton record start`");
}

Json toJson(const msg::RecorderStatus& status) {
  Json losses = Json::array();
  for (const msg::WriterLoss& loss : status.losses()) {
    losses.push_back({{"topic", loss.topic().c_str()}, {"service", loss.service().c_str()}, {"lost", loss.lost()}});
  }
  return {{"state", toString(status.state())},
          {"ring", status.ring()},
          {"path", status.path().c_str()},
          {"part", status.part()},
          {"messages", status.messages()},
          {"bytes", status.bytes()},
          {"queued", status.queued()},
          {"queued_bytes", status.queued_bytes()},
          {"disk_left_bytes", status.disk_left()},
          {"lost", status.lost()},
          {"losses", losses},
          {"acknowledged_step", status.acknowledged_step()},
          {"complete", status.complete()},
          {"text", status.text().c_str()}};
}

void print(const msg::RecorderStatus& status) {
  say("%s %s", toString(status.state()), status.path().c_str());
  if (status.part() > 0) say(", part %u", status.part());
  say("\n%llu messages, %.2f MB %s, %llu lost, every loop sample up to step %llu\n", ull{status.messages()},
      mega(status.bytes()), status.ring() ? "in memory" : "in the file", ull{status.lost()},
      ull{status.acknowledged_step()});
  say("%llu samples (%.2f MB) wait to be written, %.0f MB are left on the disk\n", ull{status.queued()},
      mega(status.queued_bytes()), mega(status.disk_left()));
  for (const msg::WriterLoss& loss : status.losses()) {
    say("  %-20s %-16s %llu lost\n", loss.topic().c_str(), loss.service().c_str(), ull{loss.lost()});
  }
  if (status.text().size() > 0) say("%s\n", status.text().c_str());
}

void recordStatus(const CellTarget& target, ExitCode& exit_code) {
  CellClient client = clientOf(target);
  requireRecorder(client);
  const auto status = client.latest(dds::topics::kRecorderStatus);
  if (!status) throw UnavailableError("the recorder says nothing; see `baton logs recorder`");
  exit_code = status->state() == msg::RECORDER_FAILED ? ExitCode::kFailed : ExitCode::kOk;
  if (target.json) {
    sayText(toText(toJson(*status)) + '\n');
  } else {
    print(*status);
  }
}

/// With the first step that is in the file or out of it, or the last.
std::string doneText(msg::RecordAction action, std::uint64_t last_before) {
  switch (action) {
    case msg::RECORD_START: return fmt::format("recording from step {} on", last_before + 1);
    case msg::RECORD_STOP: return fmt::format("ended behind step {}", last_before);
    case msg::RECORD_PAUSE: return fmt::format("paused from step {} on", last_before + 1);
    case msg::RECORD_RESUME: return fmt::format("recording again from step {} on", last_before + 1);
    case msg::RECORD_SNAPSHOT: return fmt::format("written up to step {}", last_before);
  }
  return fmt::format("done behind step {}", last_before);
}

/// What to ask the recorder for: names are all it takes.
std::string nameOf(const std::string& out, const RunInfo& run) {
  if (out.empty()) return "";
  const std::filesystem::path path = outputPath(out).lexically_normal();
  std::string name = path.filename().string();
  if (std::filesystem::exists(path))
    throw UnavailableError("--out " + path.string() + " is there already: choose another name");
  if (!isFileName(name, ".mcap")) throw UsageError("--out " + escaped(out) + ": expected a file that ends in .mcap");
  constexpr std::size_t kMaxPath = 400;
  if (path.string().size() > kMaxPath) throw UsageError("--out: expected a path of at most 400 characters");
  sendElsewhere(run, path);
  return name;
}

void ask(const RecordArguments& arguments, msg::RecordAction action, ExitCode& exit_code) {
  CellClient client = clientOf(arguments.target);
  requireRecorder(client);
  const std::string out = nameOf(arguments.out, client.info());
  msg::RecordRequest request;
  request.request_id(CellClient::newRequestId());
  request.action(action);
  request.path(out);
  ProgressLine line;
  line.show("waiting for the recorder");
  const auto reply = client.ask<msg::RecordRequest, msg::RecordReply>(
      dds::topics::kRecordRequest, request, dds::topics::kRecordReply,
      [&](const msg::RecordReply& one) { return one.request_id() == request.request_id(); }, kRecorderName,
      action == msg::RECORD_STOP || action == msg::RECORD_SNAPSHOT ? kFilePatience : CellClient::kPatience);
  line.clear();
  if (!reply) throw UnavailableError("the recorder did not answer; see `baton record status`");
  exit_code = reply->accepted() ? ExitCode::kOk : ExitCode::kFailed;
  if (arguments.target.json) {
    sayText(toText(Json{{"accepted", reply->accepted()},
                        {"state", toString(reply->state())},
                        {"step", reply->step()},
                        {"path", reply->path().c_str()},
                        {"text", reply->text().c_str()}}) +
            '\n');
  } else if (reply->accepted()) {
    const std::string text = reply->text().c_str();
    say("%s: %s%s\n", doneText(action, reply->step()).c_str(), reply->path().c_str(),
        text.empty() ? "" : (", " + text).c_str());
  } else {
    say("refused at step %llu: %s\n", ull{reply->step()}, reply->text().c_str());
  }
}

/// Needs no run, and so none of the options that find one: everything after its name is for the recorder.
void addTraffic(CLI::App& record) {
  CLI::App* command = record.add_subcommand("traffic", "record what is published in a DDS domain, without a run");
  command->prefix_command();
  command->set_help_flag();
  command->callback([command] {
    std::vector<std::string> arguments{"baton-recorder", "--traffic"};
    const std::vector<std::string> rest = command->remaining();
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    become("baton-recorder", std::move(arguments));
  });
}

}  // namespace

void addRecordCommand(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("record", "what the run's recorder does; or record any DDS traffic");
  command->require_subcommand(1);
  command->footer(
      "The run goes on whatever is asked here. What is left out on purpose is told in the certificate, step by\n"
      "step, and makes no recording incomplete. Steps are those of plant_state; in JSON, \"step\" is the last one\n"
      "before what was asked took effect.\n"
      "Exit codes: 0 done; 1 refused, or the recorder has failed; 2 wrong input; 3 no run, no recorder, no answer,\n"
      "or the file is there already.");
  const auto arguments = std::make_shared<RecordArguments>();
  const auto add = [&](const char* name, const char* help) {
    return addCellCommand(*command, arguments->target, name, help);
  };
  const auto addRequest = [&](const char* name, const char* help, msg::RecordAction action) {
    CLI::App* sub = add(name, help);
    sub->callback([=, &exit_code] { ask(*arguments, action, exit_code); });
    return sub;
  };
  add("status", "what has been recorded so far, what waits, what is lost")->callback([=, &exit_code] {
    recordStatus(arguments->target, exit_code);
  });
  addRequest("start", "begin a file: in a run that was started with --record-later, or after stop", msg::RECORD_START)
      ->add_option("--out", arguments->out, "the file (default: the one the run was started with)");
  addRequest("stop", "end the file, with its certificate; `record start --out FILE` begins another", msg::RECORD_STOP);
  addRequest("pause", "write nothing until resume: a hole in the file, on purpose", msg::RECORD_PAUSE);
  addRequest("resume", "go on in the same file", msg::RECORD_RESUME);
  addRequest("snapshot", "write what a ring holds (recording: {ring_s: SECONDS}); it goes on", msg::RECORD_SNAPSHOT)
      ->add_option("--out", arguments->out, "the file (default: beside the run's recording, named after the step)");
  addTraffic(*command);
}

}  // namespace baton
