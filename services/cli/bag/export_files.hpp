/// The files that `bag export` writes: complete under their name, or not there.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mcap/file.hpp"

namespace baton {

/// A file name for a topic: what could mean a folder, or surprise a shell, becomes '_'.
[[nodiscard]] std::string fileNameFor(const std::string& topic);

/// Gathers text; the file is there once it is finished.
class ExportFile {
 public:
  /// Throws UnavailableError when it cannot be created.
  explicit ExportFile(const std::filesystem::path& path);

  void add(std::string_view text);
  void finish();

 private:
  void flush();

  mcap::OutputFile file_;
  std::string text_;
};

}  // namespace baton
