#include "bag/export_files.hpp"

#include <algorithm>
#include <cctype>

#include "base/error.hpp"
#include "mcap/bytes.hpp"

namespace baton {
namespace {

constexpr std::size_t kBufferBytes = 1U << 16;

std::filesystem::path partOf(std::filesystem::path path) { return path += ".part"; }

}  // namespace

std::string fileNameFor(const std::string& topic) {
  std::string name = topic;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-' && c != '.'; }, '_');
  if (name.empty() || name.front() == '.' || name.front() == '-') name.insert(0, "_");
  constexpr std::size_t kMaxLength = 200;  // file systems take 255
  return name.substr(0, kMaxLength);
}

ExportFile::ExportFile(std::filesystem::path path)
    : path_(std::move(path)), file_(partOf(path_), mcap::OutputFile::IfExists::kReplace) {}

ExportFile::~ExportFile() {
  std::error_code ignored;
  if (!is_finished_) std::filesystem::remove(partOf(path_), ignored);
}

void ExportFile::add(std::string_view text) {
  text_ += text;
  if (text_.size() >= kBufferBytes) flush();
}

void ExportFile::flush() {
  file_.write(mcap::asBytes(text_));
  text_.clear();
}

void ExportFile::finish() {
  flush();
  file_.close();
  std::error_code error;
  std::filesystem::rename(partOf(path_), path_, error);
  if (error) throw UnavailableError(path_.string() + ": cannot be written: " + error.message());
  is_finished_ = true;
}

}  // namespace baton
