#include "foamCases/slump_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/pieces.h"

namespace flowrest::foam {

namespace {

constexpr double most_cells = 5e6;

int cells_over(double length, double cell) {
  return static_cast<int>(std::lround(std::fmax(1.0, length / cell)));
}

void check_extent(const scenes::Scene& scene, double domain_height, double columns) {
  const double body_height = scene.body_height();
  const double cell = scene.foam.cell;
  if (!(cell > 0.0))
    throw scenes::SceneError(fmt::format(
        "{}: foam.cell is missing; `flowrest foam` needs a cell size above 0 m", scene.path.string()));
  if (domain_height < body_height + cell)
    throw scenes::SceneError(
        fmt::format("{}: geometry.domain_height is {:g} m; it must leave a cell of air above the cone, so at "
                    "least {:g} m",
                    scene.path.string(), domain_height, body_height + cell));
  const double cells = columns * (domain_height / cell);
  if (cells > most_cells)
    throw scenes::SceneError(
        fmt::format("{}: foam.cell = {:g} m gives {:.3g} cells; at most {:.0e} are allowed",
                    scene.path.string(), cell, cells, most_cells));
}

}  // namespace

int cells_along_radius(const scenes::Scene& scene) {
  return cells_over(scenes::pieces_of(scene).domain->radius, scene.foam.cell);
}

SlumpRows slump_rows(const scenes::Scene& scene, double columns) {
  const double body_height = scene.body_height(), domain_height = scenes::pieces_of(scene).domain->height;
  check_extent(scene, domain_height, columns);
  const double cell = scene.foam.cell;
  const int rows = std::max(2, cells_over(body_height, cell));
  SlumpRows result;
  const double thin = scene.foam.base_height.value_or(0.0) * rows / body_height;
  const int cut = std::clamp(static_cast<int>(std::lround(thin)), 1, rows - 1);
  result.base_rows = cut * std::max(1, scene.foam.base_rows);
  result.cone_rows = rows - cut;
  result.air_rows = cells_over(domain_height - body_height, cell);
  result.cone_row_height = body_height / rows;
  result.base_row_height = cut * result.cone_row_height / result.base_rows;
  result.air_row_height = (domain_height - body_height) / result.air_rows;
  return result;
}

}  // namespace flowrest::foam
