/// gnuplot, as everything here draws with it: a script with its data inside, made into an SVG and a PNG.
#pragma once

#include <filesystem>
#include <string>

namespace baton {

/// Of the first, second, ... curve of a panel.
inline constexpr const char* kCurveColours[] = {"#1f6fb4", "#c8452c", "#2c8c4a", "#8b5ab5", "#b5852a"};

/// Text for a script. In single quotes gnuplot takes it as it is; in double quotes it would run what stands in
/// backquotes.
[[nodiscard]] std::string quoted(const std::string& text);

struct PictureSize {
  std::size_t width = 0;
  std::size_t height = 0;  // pixels
};

/// Writes `stem`.gp, `data` first, then `commands` once for each of `stem`.svg and `stem`.png, and lets gnuplot make
/// them. Throws UnavailableError when that cannot be.
void drawScript(const std::filesystem::path& stem, const PictureSize& size, const std::string& data,
                const std::string& commands);

/// Throws UnavailableError when gnuplot is missing, before anybody has waited for what it is to draw.
void expectGnuplot();

}  // namespace baton
