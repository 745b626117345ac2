#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bag/copy_target.hpp"
#include "bag/interruption.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "base/plural.hpp"
#include "base/text.hpp"
#include "dds/hash.hpp"
#include "mcap/repeated.hpp"
#include "report/recording.hpp"
#include "runtime/json.hpp"
#include "runtime/progress_line.hpp"
#include "runtime/recording_files.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

struct MergeRequest {
  std::vector<std::string> given;  // recordings, and last the file to make
  CopyTarget out;
  bool json = false;
};

/// One of the recordings, and how far it has been read.
struct Source {
  std::string label;  // unique, for names
  std::unique_ptr<mcap::Reader> reader;
  std::unique_ptr<mcap::MessageCursor> cursor;
  mcap::MessageView next;
  bool is_first_of_run = true;  // of the files that have the same run
  mcap::Repeated repeated{};    // what it begins with from before and a file before it has

  [[nodiscard]] bool advance() {
    while (cursor->next(next)) {
      if (!repeated.takes(next)) return true;
    }
    return false;
  }
};

std::vector<Source> openSources(const std::vector<std::string>& files) {
  std::vector<Source> sources;
  std::set<std::string> labels;
  for (const std::string& file : files) {
    const std::string stem = std::filesystem::path(file).stem().string();
    Source source{.label = stem, .reader = openForCopy(file), .cursor = nullptr, .next = {}};
    for (int i = 2; !labels.insert(source.label).second; ++i) source.label = fmt::format("{}-{}", stem, i);
    sources.push_back(std::move(source));
  }
  for (Source& source : sources) {
    const std::string run = metadataValue(*source.reader, "baton.run", "run");
    const auto begin_ns = [](const Source& one) { return one.reader->statistics().start_time_ns; };
    std::vector<const mcap::Reader*> before;  // of the same run
    for (const Source& other : sources) {
      const bool is_before = !run.empty() && begin_ns(other) < begin_ns(source);
      if (is_before && metadataValue(*other.reader, "baton.run", "run") == run) before.push_back(other.reader.get());
    }
    source.is_first_of_run = before.empty();
    if (!source.is_first_of_run) source.repeated = mcap::Repeated(*source.reader, before);
  }
  return sources;
}

/// Together they are one recording that was split: where none of it is missing, what its certificate says holds for
/// them.
bool areParts(const std::vector<Source>& sources) {
  const auto identityOf = [](const Source& source) {
    return std::pair(metadataValue(*source.reader, "baton.run", "run"),
                     metadataValue(*source.reader, "baton.part", "first"));
  };
  std::set<unsigned> indexes;
  for (const Source& source : sources) {
    const auto index = partIndex(*source.reader);
    if (!index || !source.reader->info().is_complete || identityOf(source) != identityOf(sources.front())) return false;
    indexes.insert(*index);
  }
  return !identityOf(sources.front()).first.empty() && indexes.size() == sources.size();
}

/// Names as they are, unless files have different things of one name: then each has its file's name in front. What is
/// the same in several files is there once.
class Names {
 public:
  void note(const std::string& name, std::uint64_t hash) { contents_[name].insert(hash); }
  /// The name in the merged file; empty for something that is there already.
  std::string take(const std::string& label, const std::string& name, std::uint64_t hash) {
    const std::string result = contents_.at(name).size() > 1 ? label + "/" + name : name;
    return taken_.insert({result, hash}).second ? result : "";
  }

 private:
  std::map<std::string, std::set<std::uint64_t>> contents_;
  std::set<std::pair<std::string, std::uint64_t>> taken_;
};

std::uint64_t hashOf(const mcap::StringMap& values) {
  std::uint64_t hash = 0;
  for (const auto& [key, value] : values) {
    hash = dds::chainHash(dds::chainHash(hash, mcap::asBytes(key)), mcap::asBytes(value));
  }
  return hash;
}

/// Calls f(source, name, hash, write) for each metadata record and each attachment: write(name) puts it into the copy.
template <class F>
void forEachExtra(const std::vector<Source>& sources, bool is_whole, mcap::Copier* copy, const F& f) {
  for (const Source& source : sources) {
    const auto nameOf = [&](const std::string& name) { return is_whole ? name : withoutClaim(name); };
    for (const mcap::Metadata& one : source.reader->metadata()) {
      if (one.name == mcap::kRepeatedRecord && !source.is_first_of_run) continue;
      f(source, "metadata", nameOf(one.name), hashOf(one.values),
        [&](const std::string& name) { copy->metadata(name, one.values); });
    }
    for (const mcap::AttachmentIndex& index : source.reader->attachments()) {
      const mcap::Bytes data = source.reader->readAttachment(index);
      f(source, "attachment", nameOf(index.name), dds::chainHash(0, data),
        [&](const std::string& name) { copy->attachment(name, index, data); });
    }
  }
}

void copyExtras(const std::vector<Source>& sources, bool is_whole, mcap::Copier& copy) {
  std::map<std::string, Names> names;  // by kind
  forEachExtra(sources, is_whole, nullptr,
               [&](const Source&, const std::string& kind, const auto& name, std::uint64_t hash, const auto&) {
                 names[kind].note(name, hash);
               });
  forEachExtra(sources, is_whole, &copy,
               [&](const Source& source, const std::string& kind, const std::string& name, std::uint64_t hash,
                   const auto& write) {
                 if (const std::string taken = names[kind].take(source.label, name, hash); !taken.empty()) write(taken);
               });
}

void copyMessages(std::vector<Source>& sources, mcap::Copier& copy) {
  std::uint64_t total = 1;
  std::vector<Source*> waiting;  // a heap, the earliest in front; at equal times in the order of the files
  const auto later = [](const Source* a, const Source* b) {
    return a->next.log_time_ns != b->next.log_time_ns ? a->next.log_time_ns > b->next.log_time_ns : a > b;
  };
  for (Source& source : sources) {
    copy.channels(*source.reader);
    total += source.reader->statistics().message_count;
    source.cursor = std::make_unique<mcap::MessageCursor>(source.reader->messages());
    if (source.advance()) waiting.push_back(&source);
  }
  std::make_heap(waiting.begin(), waiting.end(), later);
  ProgressLine line;
  while (!waiting.empty()) {
    std::pop_heap(waiting.begin(), waiting.end(), later);
    Source& first = *waiting.back();
    copy.message(first.next);
    if (copy.messages() % 0x4000 == 0) {
      const double part = static_cast<double>(copy.messages()) / static_cast<double>(total);
      line.show(fmt::format("merging {} {:3.0f} %", progressBar(part), 100.0 * part));
    }
    if (first.advance()) {
      std::push_heap(waiting.begin(), waiting.end(), later);
    } else {
      waiting.pop_back();
    }
  }
}

ExitCode merge(MergeRequest& request) {
  removeUnfinishedOnSignals();
  request.out.file = takeLast(request.given);
  const std::vector<std::string> files = filesOf({.given = request.given});
  const std::vector<std::string> missing = missingParts(files);
  for (const std::string& one : missing) sayWarning(one);
  std::vector<Source> sources = openSources(files);
  mcap::Copier copy(request.out.file, optionsFor(request.out, files));
  copyExtras(sources, missing.empty() && areParts(sources), copy);
  copyMessages(sources, copy);
  copy.finish();
  if (request.json) {
    sayText(toText({{"out", request.out.file}, {"files", files}, {"messages", copy.messages()}, {"missing", missing}}) +
            '\n');
  } else {
    sayf("merged      {} into {}: {}\n", counted(sources.size(), "file"), request.out.file,
         counted(copy.messages(), "message"));
  }
  return missing.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addBagMerge(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<MergeRequest>();
  CLI::App* command = bag.add_subcommand("merge", "several recordings as one, in the order of their log times");
  command->footer(
      "Each writer keeps a channel of its own; metadata and attachments of one name that differ get the name of their\n"
      "file in front. All parts of a recording that was split give the whole one, with its certificate; of anything\n"
      "else no certificate holds, and it is kept under the name original_...\n"
      "Exit codes: 0 done; 1 OUT could not be written, or it is there and parts of a split recording are missing in\n"
      "it; 2 damaged or not a recording (`bag recover` makes a sound one); 3 a file cannot be opened, or OUT is\n"
      "there already or cannot be made.");
  command->add_option("files", request->given, "recordings (MCAP) or folders of them, and then the recording to make")
      ->required();
  addOverwrite(*command, request->out);
  command->add_flag("--json", request->json, "as a JSON object");
  command->callback([request, &exit_code] { exit_code = merge(*request); });
}

}  // namespace baton
