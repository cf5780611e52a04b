#include "foamCases/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "foamCases/case_filler.h"
#include "foamCases/quarter_grid.h"
#include "foamCases/vessel_mesh.h"
#include "foamCases/wedge_grid.h"

namespace flowrest::foam {

namespace {

/// Of a rank, below which it would do little else than exchange them: the least that is run, and what repays
/// it.
constexpr std::size_t fewest_cells = 10, repaying_cells = 2000;

/// Different places of cells along an axis, to a micrometre.
std::size_t slices_of(const BlockLattice& mesh, std::size_t axis) {
  std::set<long> places;
  for (const MeshCell& cell : mesh_cells(mesh)) places.insert(std::lround(1e6 * cell.centre()[axis]));
  return places.size();
}

std::string sensible(const Divisible& mesh, int cores) {
  return fmt::format("sensible: {} (some {} cells to a rank, at most {} slices of cells and {} core{})",
                     sensible_ranks(mesh, cores), repaying_cells, mesh.slices, cores, cores == 1 ? "" : "s");
}

}  // namespace

Divisible divisible(const scenes::Scene& scene) {
  if (scene.kind() == scenes::Kind::duct) return {duct_cells(scene), 1};
  if (is_vessel(scene)) {
    // As the cases' decomposeParDict have it: a funnel's slices lie one over another.
    const std::size_t axis = scene.kind() == scenes::Kind::v_funnel ? 2 : 0;
    return {mesh_cells(scene), slices_of(vessel_mesh(scene), axis)};
  }
  const bool quarter = scene.geometry.dimension == scenes::Dimension::quarter;
  return {mesh_cells(scene),
          static_cast<std::size_t>(quarter ? quarter_grid(scene).side : wedge_grid(scene).rings)};
}

int sensible_ranks(const Divisible& mesh, int cores) {
  const std::size_t most =
      std::min({mesh.cells / repaying_cells, mesh.slices, static_cast<std::size_t>(cores)});
  return static_cast<int>(std::max<std::size_t>(most, 1));
}

void check_ranks(const scenes::Scene& scene, int ranks, int cores) {
  if (ranks <= 1) return;
  if (scene.kind() == scenes::Kind::duct)
    throw scenes::SceneError(
        fmt::format("{}: --ranks {}: a duct is one column of cells; allowed: 1", scene.path.string(), ranks));
  const Divisible mesh = divisible(scene);
  const std::size_t most = std::max<std::size_t>(mesh.cells / fewest_cells, 1);
  if (static_cast<std::size_t>(ranks) > most)
    throw scenes::SceneError(
        fmt::format("{}: --ranks {}: the mesh has {} cells, {:.2g} to a rank; allowed: at most {} ({} cells "
                    "to a rank); {}",
                    scene.path.string(), ranks, mesh.cells, static_cast<double>(mesh.cells) / ranks, most,
                    fewest_cells, sensible(mesh, cores)));
}

std::string too_many_ranks(const scenes::Scene& scene, int ranks, int cores) {
  if (ranks <= 1) return "";
  const Divisible mesh = divisible(scene);
  std::string more;
  if (static_cast<std::size_t>(ranks) > mesh.slices)
    more = fmt::format("the {} slices of cells that the mesh is cut between", mesh.slices);
  if (ranks > cores)
    more += fmt::format("{}the {} core{} of this machine", more.empty() ? "" : " and than ", cores,
                        cores == 1 ? "" : "s");
  if (more.empty()) return "";
  return fmt::format("--ranks {} are more than {}: it takes longer than with fewer; {}", ranks, more,
                     sensible(mesh, cores));
}

}  // namespace flowrest::foam
