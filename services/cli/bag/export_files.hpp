/// The files that `bag export` writes: complete under their name, or not there.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mcap/file.hpp"

namespace baton {

/// A file name for a topic: what could mean a folder, or surprise a shell, becomes '_'.
[[nodiscard]] std::string fileNameFor(const std::string& topic);

/// Gathers text and writes it to PATH.part, which becomes PATH when it is finished.
class ExportFile {
 public:
  /// Throws UnavailableError when it cannot be created.
  explicit ExportFile(std::filesystem::path path);
  /// Takes away what was not finished.
  ~ExportFile();
  ExportFile(const ExportFile&) = delete;
  ExportFile& operator=(const ExportFile&) = delete;

  void add(std::string_view text);
  void finish();

 private:
  void flush();

  std::filesystem::path path_;
  mcap::OutputFile file_;
  std::string text_;
  bool is_finished_ = false;
};

}  // namespace baton
