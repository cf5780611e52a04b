#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/report/page.h"

/// Figures for papers and clips for talks, drawn by gnuplot from the same model as the page. (VTK's charts,
/// drawn under a virtual display, were looked at too: legends over curves, crowded ticks, and ten times the
/// time.)
namespace flowrest::report {

/// Writes every plot, bars, profiles (at their last time) and section (at three times) of the page into
/// `folder` as ID.svg and ID.png, with figures.gp, the gnuplot script that draws them again.
/// @return the names written.
/// @throws runs::MissingProgram where gnuplot is not installed; runs::RunError where it fails or a figure is
/// not whole and of its size.
std::vector<std::string> write_figures(const Page&, const std::filesystem::path& folder);

/// Writes the section's times one after the other as a clip, WebM or GIF by the file's name; shows its
/// progress unless `quiet`.
/// @throws runs::MissingProgram where gnuplot or ffmpeg is not installed; runs::RunError where one of them
/// fails or the clip does not hold every time in full size.
void write_clip(const Page&, const Section&, const std::filesystem::path& file, bool quiet = false);

}  // namespace flowrest::report
