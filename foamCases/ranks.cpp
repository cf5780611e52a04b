#include "foamCases/ranks.h"

#include <fmt/format.h>

#include <algorithm>

#include "foamCases/apparatus/apparatus.h"

namespace flowrest::foam {

namespace {

/// Of a rank, below which it would do little else than exchange them: the least that is run, and what repays
/// it.
constexpr std::size_t fewest_cells = 10, repaying_cells = 2000;

std::string sensible(const Divisible& mesh, int cores) {
  return fmt::format("sensible: {} (some {} cells to a rank, at most {} slices of cells and {} core{})",
                     sensible_ranks(mesh, cores), repaying_cells, mesh.slices, cores, cores == 1 ? "" : "s");
}

}  // namespace

Divisible divisible(const scenes::Scene& scene) {
  const auto apparatus = case_of(scene);
  return {apparatus->cells(), apparatus->slices()};
}

int sensible_ranks(const Divisible& mesh, int cores) {
  const std::size_t most =
      std::min({mesh.cells / repaying_cells, mesh.slices, static_cast<std::size_t>(cores)});
  return static_cast<int>(std::max<std::size_t>(most, 1));
}

void check_ranks(const scenes::Scene& scene, int ranks, int cores) {
  if (ranks <= 1) return;
  const Divisible mesh = divisible(scene);
  if (mesh.slices == 1)
    throw scenes::SceneError(fmt::format("{}: --ranks {}: a {} is one column of cells; allowed: 1",
                                         scene.path.string(), ranks,
                                         scenes::name_of(scene.geometry.apparatus)));
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
