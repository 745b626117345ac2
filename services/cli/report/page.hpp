/// The page of figures: one HTML file beside its drawings, to be read without anything else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figure_list.hpp"

namespace baton {

/// A figure with what its runs showed.
struct FigureResult {
  Figure figure;
  std::vector<std::string> settings;  // of the runs that were read, in their order: see settingsText()
  std::vector<std::string> drawings;  // stems of .svg and .png beside the page
  std::vector<std::string> tables;    // HTML
  std::vector<Check> checks;
  std::string failure;  // why something could not be run, measured or drawn; empty when everything could

  /// Everything was measured and agrees with theory.
  [[nodiscard]] bool agrees() const;
  /// The figure's verdict on the claim, which stands only on runs that agree with theory.
  [[nodiscard]] ClaimVerdict verdict() const { return agrees() ? figure.verdict : ClaimVerdict::kNotEstablished; }
};

struct PageFacts {
  std::string build;  // version, compiler
  double elapsed_s = 0.0;
  std::size_t runs = 0;
  std::size_t reused = 0;
};

/// Writes the page, beside the drawings. Throws UnavailableError when it cannot.
void writePage(const std::filesystem::path& file, const std::vector<FigureResult>& results,
               const std::vector<Erratum>& errata, const PageFacts& facts);

[[nodiscard]] const char* toString(ClaimVerdict verdict);

}  // namespace baton
