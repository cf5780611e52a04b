#include "foamCases/wedge_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace flowrest::foam {

namespace {

constexpr double most_cells = 5e6;

int cells_over(double length, double cell) {
  return static_cast<int>(std::lround(std::fmax(1.0, length / cell)));
}

void check_extent(const scenes::Scene& scene) {
  const auto& cone = scene.slump();
  const double cell = scene.foam.cell;
  if (!(cell > 0.0))
    throw scenes::SceneError(fmt::format(
        "{}: foam.cell is missing; `flowrest foam` needs a cell size above 0 m", scene.path.string()));
  if (cone.domain_height < cone.cone_height + cell)
    throw scenes::SceneError(
        fmt::format("{}: geometry.domain_height is {:g} m; it must leave a cell of air above the cone, so at "
                    "least {:g} m",
                    scene.path.string(), cone.domain_height, cone.cone_height + cell));
  const double cells = cone.domain_radius / cell * (cone.domain_height / cell);
  if (cells > most_cells)
    throw scenes::SceneError(
        fmt::format("{}: foam.cell = {:g} m gives {:.3g} cells; at most {:.0e} are allowed",
                    scene.path.string(), cell, cells, most_cells));
}

}  // namespace

double WedgeGrid::ring_area(int ring) const {
  return std::numbers::pi * ring_width * ring_width * (2.0 * ring + 1.0);
}

WedgeGrid wedge_grid(const scenes::Scene& scene) {
  check_extent(scene);
  const auto& cone = scene.slump();
  const double cell = scene.foam.cell;
  WedgeGrid grid;
  grid.rings = cells_over(cone.domain_radius, cell);
  grid.cone_rows = cells_over(cone.cone_height, cell);
  grid.air_rows = cells_over(cone.domain_height - cone.cone_height, cell);
  grid.ring_width = cone.domain_radius / grid.rings;
  grid.cone_row_height = cone.cone_height / grid.cone_rows;
  grid.air_row_height = (cone.domain_height - cone.cone_height) / grid.air_rows;
  return grid;
}

}  // namespace flowrest::foam
