#include <algorithm>
#include <compare>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bag/csv_columns.hpp"
#include "bag/export_files.hpp"
#include "bag/interruption.hpp"
#include "bag/message_text.hpp"
#include "bag/selection.hpp"
#include "bag/subcommands.hpp"
#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "runtime/paths.hpp"
#include "runtime/recorded_types.hpp"
#include "runtime/say.hpp"
#include "schema/error.hpp"

namespace baton {
namespace {

struct ExportRequest {
  Selection selection;
  bool csv = false;
  bool json = false;
  std::string folder;
  bool overwrite = false;
};

/// What is exported into one file: the messages of a topic that have the same type.
struct TableKey {
  std::string topic;
  std::string type;
  mcap::SchemaId schema{};  // one name may stand for several declarations
  auto operator<=>(const TableKey&) const = default;
};

struct Table {
  std::optional<CsvColumns> columns;  // of a CSV file; nothing for messages that stay bytes
  std::optional<ExportFile> file;
  std::uint64_t messages = 0;
};

TableKey keyOf(const mcap::MessageView& message) {
  return {message.channel->topic, typeNameOf(message), message.channel->schema_id};
}

class Export {
 public:
  explicit Export(const ExportRequest& request) : request_(request), messages_(request.selection) {}

  ExitCode run() {
    removeUnfinishedOnSignals();
    makeFolder(request_.folder);
    messages_.forEach("looking ", [&](const mcap::MessageView& message) { return look(message); });
    createFiles();
    messages_.forEach("writing ", [&](const mcap::MessageView& message) { return write(message); });
    for (auto& [key, table] : tables_) table.file->finish();
    for (const auto& [key, table] : tables_) {
      say("%s  %llu messages\n", paths_.at(key).c_str(), static_cast<unsigned long long>(table.messages));
    }
    return messages_.exitCode();
  }

 private:
  /// How wide a table a message needs.
  bool look(const mcap::MessageView& message) {
    Table& table = tables_[keyOf(message)];
    const schema::Type* type = types_.typeOf(message);
    if (!request_.csv || type == nullptr) return true;
    try {
      if (!table.columns) table.columns.emplace(*type);
      table.columns->fit(message.data);
    } catch (const schema::PayloadError&) {  // told when it is written
    } catch (const UsageError& error) {
      throw UsageError("topic " + message.channel->topic + " would be " + error.what());
    }
    return true;
  }

  void createFiles() {
    std::map<std::string, int> topics;
    for (const auto& [key, table] : tables_) ++topics[key.topic];
    std::set<std::string> names;
    for (const auto& [key, table] : tables_) {
      const std::string of_type = topics.at(key.topic) > 1 ? "-" + key.type : "";
      const std::string stem = fileNameFor(key.topic + of_type);
      std::string name = stem;
      for (int i = 2; !names.insert(name).second; ++i) name = stem + "-" + std::to_string(i);
      paths_[key] = std::filesystem::path(request_.folder) / (name + (request_.csv ? ".csv" : ".jsonl"));
    }
    for (const auto& [key, path] : paths_) {
      if (!request_.overwrite && std::filesystem::exists(path)) {
        throw UnavailableError(path.string() + " is there already: choose another folder, or give --overwrite");
      }
    }
    for (auto& [key, table] : tables_) {
      table.file.emplace(paths_.at(key));
      if (request_.csv) writeHeader(table);
    }
  }

  void writeHeader(Table& table) {
    static const std::vector<std::string> kRecorded{"service", "writer", "sequence", "log_time_ns", "publish_time_ns"};
    std::vector<std::string> names = kRecorded;
    for (const std::string& name : table.columns ? table.columns->finish() : std::vector<std::string>{"data"}) {
      // A member may be called as one of these.
      names.push_back(std::ranges::count(kRecorded, name) > 0 ? "message." + name : name);
    }
    writeRow(*table.file, names);
  }

  static void writeRow(ExportFile& file, const std::vector<std::string>& cells) {
    std::string row;
    for (const std::string& cell : cells) (row += csvField(cell)) += ',';
    row.pop_back();
    file.add(row + "\r\n");
  }

  bool write(const mcap::MessageView& message) {
    Table& table = tables_.at(keyOf(message));
    ++table.messages;
    const std::string problem = request_.csv ? writeCsv(message, table) : writeJson(message, table);
    if (!problem.empty()) {
      messages_.complain("topic " + message.channel->topic + ", message " + std::to_string(message.sequence) +
                         " is none of its type: " + problem);
    }
    return true;
  }

  std::string writeJson(const mcap::MessageView& message, Table& table) {
    std::string line;
    std::string problem = appendJsonLine(line, message, types_.typeOf(message));
    table.file->add(line += '\n');
    return problem;
  }

  std::string writeCsv(const mcap::MessageView& message, Table& table) {
    std::string problem;
    if (table.columns) {
      try {
        table.columns->fill(message.data, cells_);
      } catch (const schema::PayloadError& error) {
        std::ranges::fill(cells_, "");
        problem = error.what();
      }
    } else {
      cells_ = {hexOf(message.data)};
    }
    std::vector<std::string> row{serviceOf(*message.channel), mcap::valueOf(message.channel->metadata, "writer"),
                                 std::to_string(message.sequence), std::to_string(message.log_time_ns),
                                 std::to_string(message.publish_time_ns)};
    row.insert(row.end(), cells_.begin(), cells_.end());
    writeRow(*table.file, row);
    return problem;
  }

  const ExportRequest& request_;
  SelectedMessages messages_;
  RecordedTypes types_{[this](const std::string& problem) { messages_.complain(problem); }};
  std::map<TableKey, Table> tables_;
  std::map<TableKey, std::filesystem::path> paths_;
  std::vector<std::string> cells_;
};

}  // namespace

void addBagExport(CLI::App& bag, ExitCode& exit_code) {
  const auto request = std::make_shared<ExportRequest>();
  CLI::App* command = bag.add_subcommand("export", "the messages as tables (CSV) or JSON lines, one file a topic");
  command->footer(
      std::string(kRangeHelp) +
      "All writers of a topic share its file, in order of log time; the columns service and writer tell them apart.\n"
      "CSV (RFC 4180): a column for each number, string and enum, named as in the message with its unit behind it,\n"
      "\"tip_position[0] [m]\"; sequences have as many columns as the longest in the recording, and cells are empty\n"
      "where a message has fewer. Booleans are 1 and 0, octets hex. JSON: the lines that `baton bag cat` prints.\n"
      "Two passes over the recording, of which a chunk is held at a time, and those that overlap it in time. A file\n"
      "has its name only when it is complete.\n"
      "Exit codes: 0 all was exported, 1 some of it is cut, damaged or none of its type and the rest was exported,\n"
      "2 wrong input or not a recording, 3 cannot be opened or written, or a file is there already.");
  addTopicSelection(*command, request->selection);
  addRange(*command, request->selection.range);
  CLI::Option* csv = command->add_flag("--csv", request->csv, "tables, TOPIC.csv");
  command->add_flag("--json", request->json, "JSON lines, TOPIC.jsonl")->excludes(csv);
  command->add_option("--out", request->folder, "folder for the files; made when it is not there")->required();
  command->add_flag("--overwrite", request->overwrite, "replace files that are there already");
  command->callback([request, &exit_code] {
    if (request->csv == request->json) throw UsageError("expected --csv or --json, found neither");
    exit_code = Export(*request).run();
  });
}

}  // namespace baton
