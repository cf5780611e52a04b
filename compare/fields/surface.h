#pragma once

#include <filesystem>
#include <vector>

#include "compare/comparison.h"

/// Surfaces of bodies of material points, for slicers and CAD.
namespace flowrest::compare::fields {

/// A body in space as particles.
struct Parcels {
  std::vector<double> x, y, z;  ///< m
  std::vector<double> volume;   ///< m3
  double spacing = 0.0;         ///< m, between particles
  bool half = false;            ///< what is behind the plane y = 0 is its mirror image
  bool quarter = false;         ///< and behind x = 0
};

/// Writes the surface on which the particles fill half of the room as binary STL in metres: closed, normals outwards.
/// Volume fades over the particles' spacing; a floor at z = 0 stays plane. @return its volume in m3
/// @throws runs::RunError where there is nothing to draw or the file cannot be written.
double write_surface(const Parcels&, const std::filesystem::path& stl);

/// The last snapshot of every run in space, LABEL.stl in a folder. @return the files; those of runs without
/// particles in space are left out.
std::vector<std::filesystem::path> write_surfaces(const Comparison&, const std::filesystem::path& folder);

}  // namespace flowrest::compare::fields
