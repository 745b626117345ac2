#include "bag/copy_target.hpp"

#include <filesystem>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mcap/repeated.hpp"
#include "runtime/say.hpp"

namespace baton {

void addOverwrite(CLI::App& command, CopyTarget& target) {
  command.add_flag("--overwrite", target.overwrite, "replace OUT if it is there");
}

std::string takeLast(std::vector<std::string>& given) {
  if (given.size() < 2) throw UsageError("expected recordings and then the file to make, found " + given.front());
  std::string file = std::move(given.back());
  given.pop_back();
  return file;
}

mcap::WriterOptions optionsFor(const CopyTarget& target, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const std::string& input : inputs) {
    if (!std::filesystem::equivalent(input, target.file, ignored)) continue;
    throw UsageError(target.file + " is the recording that is read: choose another name for the copy");
  }
  if (!target.overwrite && std::filesystem::exists(target.file, ignored)) {
    throw UnavailableError(target.file + " is there already: choose another name, or give --overwrite");
  }
  mcap::WriterOptions options;
  options.library = "baton " BATON_VERSION;
  if (target.overwrite) options.if_exists = mcap::OutputFile::IfExists::kReplace;
  return options;
}

void sayHowItIs(const std::string& file, const mcap::FileInfo& info) {
  if (!info.is_complete) {
    const char* use = info.is_cut ? "is not whole, and is used as far as it goes" : "is copied without them";
    say(stderr, "%s %s: %s\n", file.c_str(), use, escaped(info.problem).c_str());
  }
  for (const std::string& text : info.contradictions) {
    say(stderr, "%s is copied as its data have it: %s\n", file.c_str(), escaped(text).c_str());
  }
}

std::unique_ptr<mcap::Reader> openForCopy(const std::string& file) {
  auto reader = std::make_unique<mcap::Reader>(file);
  sayHowItIs(file, reader->info());
  return reader;
}

std::string withoutClaim(const std::string& name) {
  if (name == mcap::kRepeatedRecord) return "baton.original_latched";
  if (name == "baton.certificate") return "baton.original_certificate";
  return name == "certificate.json" ? "original_certificate.json" : name;
}

}  // namespace baton
