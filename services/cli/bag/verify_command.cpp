#include <spdlog/fmt/fmt.h>

#include <memory>
#include <string>
#include <vector>

#include "bag/subcommands.hpp"
#include "bag/verify.hpp"
#include "base/plural.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

struct VerifyRequest {
  RecordingWish recording;
  bool json = false;
};

void printText(const Verification& found) {
  sayf("{}: {}\n", fmt::format("{}", fmt::join(found.files, ", ")), nameOf(found.verdict()));
  if (found.verdict() == RecordingVerdict::kComplete) {
    if (found.is_traffic) {
      sayf("            as received: by the bytes no sample is missing between a writer's first and last. It is\n");
      sayf("            traffic without manifests, so what was sent before and after that is not known\n");
    } else if (found.ledger.servicesHeard() > 0) {
      const std::size_t services = found.ledger.servicesHeard();
      sayf("            proven from the bytes: {} {} sent, all of it is here\n", counted(services, "service"),
           services == 1 ? "vouches for what it" : "vouch for what they");
    } else {
      sayf("            by the bytes no sample is missing between a writer's first and last; the run went on\n");
      sayf("            when this ended, so nobody vouches for what was sent last\n");
    }
    sayf("            and the certificate in the file agrees; every checksum is right\n");
    if (found.summary != "complete")
      sayf("            by its certificate: {}\n", found.summary.empty() ? "unknown" : found.summary);
  }
  for (const auto* findings : {&found.damage, &found.cuts, &found.missing}) {
    for (const std::string& text : *findings) sayf("            {}\n", text);
  }
  if (!found.damage.empty() || !found.cuts.empty()) {
    sayf("            `bag recover` makes a recording of all that can be read, with an index that is right\n");
  }
  for (const std::string& text : found.remarks) sayf("note        {}\n", text);
  for (const std::string& text : found.log_times.findings()) sayf("note        {}\n", text);
  sayf("messages    {} in {}\n", found.messages, counted(found.ledger.streams().size(), "stream"));
  sayf("size        {:.2f} MB\n", static_cast<double>(found.bytes) * 1e-6);
}

nlohmann::ordered_json toJson(const Verification& found) {
  return {{"files", found.files},
          {"verdict", nameOf(found.verdict())},
          {"damage", found.damage},
          {"cuts", found.cuts},
          {"missing", found.missing},
          {"remarks", found.remarks},
          {"clock", found.log_times.findings()},
          {"certificate", found.summary},
          {"traffic", found.is_traffic},
          {"manifests", found.is_traffic ? 0 : found.ledger.servicesHeard()},
          {"messages", found.messages},
          {"size_B", found.bytes},
          {"streams", nlohmann::ordered_json::parse(found.ledger.certificate()).at("streams")}};
}

ExitCode verify(const VerifyRequest& request) {
  ProgressLine line;
  std::vector<std::string> unreadable;
  const std::vector<std::string> files = filesOf(request.recording, &unreadable);
  const auto progress = [&line](double part) {
    line.show(fmt::format("verifying {} {:3.0f} %", progressBar(part), 100.0 * part));
  };
  const Verification found = verifyRecording(files, progress, unreadable);
  line.clear();
  if (request.json) {
    sayText(toText(toJson(found)) + '\n');
  } else {
    printText(found);
  }
  return exitCodeOf(found.verdict());
}

}  // namespace

void addBagVerify(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<VerifyRequest>();
  CLI::App* command = bag.add_subcommand("verify", "prove again, from its bytes, that a recording is complete");
  command->footer(
      "Reads everything and checks every checksum; counts and hashes each writer's messages again, and compares\n"
      "them with what the services say they sent and with the certificate in the file. What is lost of topics that\n"
      "are none of Baton's is a note (`remarks`): the verdict is on the run.\n"
      "Exit codes: 0 proven complete; 1 incomplete, cut or without a certificate; 2 damaged or not a recording;\n"
      "3 cannot be opened.");
  addRecording(*command, request->recording, "files",
               "a recording (MCAP); several, or a folder of them: the parts of one that was split");
  command->add_flag("--json", request->json, "as a JSON object, with every stream");
  command->callback([request, &exit_code] { exit_code = verify(*request); });
}

}  // namespace baton
