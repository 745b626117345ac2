#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bag/copy_target.hpp"
#include "bag/interruption.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "base/plural.hpp"
#include "runtime/json.hpp"
#include "runtime/paths.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {
namespace fs = std::filesystem;

struct RecoverRequest {
  std::vector<std::string> given;  // recordings, and last what to make
  bool with_parts = false;
  CopyTarget out;
  bool json = false;
};

/// One of them.
struct Job {
  std::string in;
  CopyTarget out;
};

/// "3 chunks and 120 messages are lost"; empty for none.
std::string lostIn(const mcap::Recovery& found) {
  std::string text;
  for (const auto& [count, what] : {std::pair(found.lost_chunks, "chunk"), {found.lost_messages, "message"}}) {
    if (count == 0) continue;
    text += (text.empty() ? "" : " and ") + counted(count, what);
  }
  if (text.empty()) return "";
  return text + " " + areOrIs(found.lost_chunks + found.lost_messages) + " lost";
}

/// What the input was, in a sentence.
std::string verdictOn(const mcap::Recovery& found) {
  const std::string lost = lostIn(found);
  if (found.lost_bytes > 0) {
    return fmt::format("{} of its bytes could not be read{}", found.lost_bytes,
                       lost.empty() ? "" : ": at least " + lost);
  }
  if (!found.lost.empty()) {
    return "all of its bytes could be read, and " + (lost.empty() ? "something is missing" : lost);
  }
  if (found.is_whole) return "it was whole, and is copied";
  if (!found.info.foreign.empty() && !found.is_changed && !found.info.is_cut) {
    return "all that belongs to a recording could be read, and is copied";
  }
  if (found.is_changed)
    return "bytes between its chunks were changed, as the CRC of its data says: something may be lost";
  if (!found.info.contradictions.empty()) return "all of it could be read, and is copied as its data have it";
  if (found.info.problem.empty()) return "all of it could be read, and is copied but for what MCAP does not know";
  return "nothing was lost, it has its index again: " + found.info.problem;
}

void printText(const Job& job, const mcap::Recovery& found) {
  sayf("{}: {}\n", job.in, verdictOn(found));
  for (const mcap::Damage& damage : found.lost) {
    if (damage.length == 0) {
      sayf("lost        {}\n", mcap::describe(damage));
    } else {
      sayf("lost        {} from byte {} on{}: {}\n", counted(damage.length, "byte"), damage.offset,
           damage.messages > 0 ? ", with " + counted(damage.messages, "message") : "", damage.reason);
    }
  }
  constexpr std::size_t kMostForeign = 20;
  const std::vector<mcap::Damage>& foreign = found.info.foreign;
  for (std::size_t i = 0; i < std::min(foreign.size(), kMostForeign); ++i) sayf("left out    {}\n", foreign[i].reason);
  if (foreign.size() > kMostForeign) sayf("left out    and in {} more places\n", foreign.size() - kMostForeign);
  for (const std::string& note : found.info.contradictions) sayf("note        {}\n", note);
  if (found.info.unknown_records > 0) {
    sayf("left out    {} of kinds that MCAP does not know\n", counted(found.info.unknown_records, "record"));
  }
  sayf("recovered   {}: {}, {}, {}\n", job.out.file, counted(found.messages, "message"),
       counted(found.attachments, "attachment"), counted(found.metadata, "metadata record"));
}

nlohmann::ordered_json toJson(const Job& job, const mcap::Recovery& found) {
  nlohmann::ordered_json lost = nlohmann::ordered_json::array();
  for (const mcap::Damage& damage : found.lost) {
    lost.push_back({{"from_B", damage.offset},
                    {"length_B", damage.length},
                    {"messages", damage.messages},
                    {"chunks", damage.chunks},
                    {"reason", damage.reason}});
  }
  nlohmann::ordered_json foreign = nlohmann::ordered_json::array();
  for (const mcap::Damage& one : found.info.foreign) {
    foreign.push_back({{"from_B", one.offset}, {"length_B", one.length}});
  }
  return {{"file", job.in},
          {"out", job.out.file},
          {"whole", found.is_whole},
          {"verdict", verdictOn(found)},
          {"lost_B", found.lost_bytes},
          {"lost", lost},
          {"foreign", foreign},
          {"lost_messages", found.lost_messages},
          {"left_out",
           {{"size_B", found.lost_bytes},
            {"messages", found.lost_messages},
            {"chunks", found.lost_chunks},
            {"unknown_records", found.info.unknown_records}}},
          {"notes", found.info.contradictions},
          {"messages", found.messages},
          {"attachments", found.attachments},
          {"metadata", found.metadata}};
}

mcap::Recovery recoverOne(const Job& job) {
  ProgressLine line;
  mcap::RecoverOptions options;
  options.writer = optionsFor(job.out, {job.in});
  options.lossy_name = withoutClaim;
  options.progress = [&line](double part) {
    line.show(fmt::format("recovering {} {:3.0f} %", progressBar(part), 100.0 * part));
  };
  return mcap::recover(job.in, job.out.file, options);
}

/// Of one file its copy; of several, each under its own name in a folder. What stands in the way of one is said before
/// any is made.
std::vector<Job> jobsOf(const RecoverRequest& request) {
  const std::string& in = request.given.front();
  if (request.given.size() == 1 && !request.with_parts && !fs::is_directory(in)) return {{in, request.out}};
  const fs::path folder = request.out.file;
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw UsageError(folder.string() + ": expected a folder, for the copies of several files, found a file");
  }
  std::vector<Job> jobs;
  std::set<std::string> names;
  for (const std::string& file : filesOf({.given = request.given, .with_parts = request.with_parts})) {
    jobs.push_back({file, {(folder / fs::path(file).filename()).string(), request.out.overwrite}});
    (void)optionsFor(jobs.back().out, {file});
    if (names.insert(jobs.back().out.file).second) continue;
    throw UsageError("expected files of different names, for copies in one folder, found two of " +
                     jobs.back().out.file);
  }
  makeFolder(folder);
  return jobs;
}

ExitCode recover(RecoverRequest& request) {
  removeUnfinishedOnSignals();
  request.out.file = takeLast(request.given);
  const std::vector<Job> jobs = jobsOf(request);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  bool has_all = true;
  for (const Job& job : jobs) {
    const mcap::Recovery found = recoverOne(job);
    has_all = has_all && found.lost.empty() && !found.is_changed && found.info.foreign.empty();
    if (request.json) {
      all.push_back(toJson(job, found));
    } else {
      printText(job, found);
    }
  }
  if (request.json) sayText(toText(jobs.size() == 1 ? all[0] : all) + '\n');
  return has_all ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addBagRecover(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<RecoverRequest>();
  CLI::App* command = bag.add_subcommand("recover", "make a finished recording of one that was cut or damaged");
  command->footer(
      "Copies all that can be read, and says what cannot: how many bytes, from where on, and why. A copy from which\n"
      "something is missing does not claim to be complete: its certificate is kept under the name original_...\n"
      "Records of kinds that MCAP does not know are left out, and so are bytes that belong to no recording, as where\n"
      "a file was padded: those may have been one, so the exit code is 1.\n"
      "Exit codes: 0 nothing was lost; 1 OUT is there, and something was or may be lost, or writing it failed;\n"
      "2 not a recording;\n"
      "3 IN cannot be opened, or OUT is there already or cannot be made; 130 interrupted, OUT is not there.");
  command
      ->add_option("files", request->given,
                   "recording (MCAP) and the file to make; of several, or a folder, the folder to make them in")
      ->required();
  addParts(*command, request->with_parts);
  addOverwrite(*command, request->out);
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] { exit_code = recover(*request); });
}

}  // namespace baton
