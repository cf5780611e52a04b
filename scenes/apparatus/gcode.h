#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Paths of a printer as G-code, of which pastes need little.
namespace flowrest::scenes {

/// s, then m along x, y and above the bed; linear in between.
using Waypoint = std::array<double, 4>;

/// What a G-code says.
struct PrintedPath {
  std::vector<Waypoint> places;  ///< ascending in time
  /// m3/s that hold from a time (s) on; empty where the code has no E.
  std::vector<std::pair<double, double>> flow;
};

/// Reads G0, G1 (X, Y, Z in millimetres, F in millimetres a minute, E), G4 (P in ms or S in s), G20, G21, G90, G91,
/// G92, M82 and M83; comments after ; and in brackets are read over. Moves go straight at their speed F from one
/// place to the next, without ramps. E counts material: `volume_per_e` m3 each. The path begins where the first
/// move ends.
/// On failure returns the faults, a line each: "line 12: M104 is not understood; allowed: ...".
struct GcodeResult {
  std::optional<PrintedPath> path;
  std::vector<std::string> faults;
};
GcodeResult read_gcode(const std::string& text, double volume_per_e);

}  // namespace flowrest::scenes
