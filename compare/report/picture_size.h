#pragma once

#include <array>
#include <filesystem>
#include <optional>

/// What other programs drew, measured.
namespace flowrest::report {

/// Width and height.
using PictureSize = std::array<int, 2>;

/// Of a whole PNG file, in pixels; nothing where it is none.
std::optional<PictureSize> png_size(const std::filesystem::path&);

/// Of a whole SVG file as gnuplot writes it; nothing where it is none.
std::optional<PictureSize> svg_size(const std::filesystem::path&);

}  // namespace flowrest::report
