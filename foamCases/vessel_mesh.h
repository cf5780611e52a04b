#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foamCases/block_mesh.h"
#include "scenes/scene.h"

/// The meshes of vessels that concrete flows out of or along: L-box, V-funnel and the tank of a dam break. x
/// runs along the channel or across the funnel's slopes, z upwards.
namespace flowrest::foam {

/// Whether a scene's geometry is one of these.
bool is_vessel(const scenes::Scene&);

/// The blocks of a vessel's mesh, with cells of about foam.cell.
///
/// L-box: half of it, cut along its middle; round bars are rows of cells half a bar's radius wide, their
/// corners moved onto the circle. V-funnel: a quarter, with truly inclined faces, as many cells across at
/// every height, and a short box under the outlet through whose sides what flows out leaves. Dam break: a
/// plane, one cell thick.
/// @throws scenes::SceneError where it cannot be laid out, saying what is allowed.
BlockLattice vessel_mesh(const scenes::Scene&);

/// The box that the concrete fills at the start: two corners, m. Faces of cells lie on its sides.
std::array<Point, 2> initial_box(const scenes::Scene&);

/// The plate before an L-box's opening: a rectangle across x, lifted from the floor.
struct Gate {
  Point low{}, high{};    ///< m, two corners of it, shut
  double velocity = 0.0;  ///< m/s
};

/// The gate of a scene that has one.
std::optional<Gate> gate_of(const scenes::Scene&);

/// Whole body over what the mesh holds: the missing parts, or a metre of a plane.
double whole_over_mesh(const scenes::Scene&);

/// Volume of the concrete at the start, of the whole body, m3; of a plane m3 to a metre.
double initial_volume(const scenes::Scene&);

}  // namespace flowrest::foam
