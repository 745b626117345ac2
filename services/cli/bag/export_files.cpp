#include "bag/export_files.hpp"

#include <algorithm>
#include <cctype>

#include "mcap/bytes.hpp"

namespace baton {
namespace {

constexpr std::size_t kBufferBytes = 1U << 16;

}  // namespace

std::string fileNameFor(const std::string& topic) {
  std::string name = topic;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-' && c != '.'; }, '_');
  if (name.empty() || name.front() == '.' || name.front() == '-') name.insert(0, "_");
  constexpr std::size_t kMaxLength = 200;  // file systems take 255
  return name.substr(0, kMaxLength);
}

ExportFile::ExportFile(const std::filesystem::path& path) : file_(path, mcap::OutputFile::IfExists::kReplace) {}

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
}

}  // namespace baton
