#include "foamCases/vessel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "foamCases/vessel_sampler.h"
#include "scenes/pieces.h"

namespace flowrest::foam {

namespace {

constexpr double most_cells = 5e6;

/// How many cells a mesh of these blocks has, before any is made.
double count_cells(const BlockLattice& lattice) {
  double product = 1.0;
  for (const auto& axis : lattice.cells) {
    double sum = 0.0;
    for (const int n : axis) sum += n;
    product *= sum;
  }
  return product;
}

}  // namespace

BlockLattice Vessel::mesh() const {
  const double cell = scene().foam.cell;
  if (!(cell > 0.0)) refuse("foam.cell is missing; `flowrest foam` needs a cell size above 0 m");
  auto blocks = lattice();
  if (const double cells = count_cells(blocks); cells > most_cells)
    refuse(fmt::format("foam.cell = {:g} m gives {:.3g} cells; at most {:.0e} are allowed", cell, cells,
                       most_cells));
  return blocks;
}

/// Fills the box that the concrete stands in; faces of cells lie on its sides.
std::string Vessel::mesh_parameters() const {
  const auto [low, high] = initial_box();
  return fmt::format(
      "// Concrete at the start, m: a box between two corners. The mesh is in system/blockMeshDict.\n"
      "fillLow             ({} {} {});\n"
      "fillHigh            ({} {} {});\n",
      low[0], low[1], low[2], high[0], high[1], high[2]);
}

std::vector<CaseFile> Vessel::files() const {
  const std::string what = fmt::format(
      "// The mesh of the scene '{}', m: `flowrest foam` writes it, blocks of cells of about {} m. x runs along "
      "the\n// channel or across the funnel's slopes, z upwards. Gauges count on the order of the cells.\n",
      scene().name, scene().foam.cell);
  return {{"system/blockMeshDict", block_mesh_dictionary(mesh(), what)}};
}

std::unique_ptr<Sampler> Vessel::sampler(CaseFields fields, runs::RunWriter& writer, bool plug_in) const {
  return std::make_unique<VesselSampler>(scene(), mesh_cells(mesh()), std::move(fields), writer, plug_in);
}

void Vessel::check_dimension(scenes::Dimension allowed) const {
  using scenes::Dimension;
  if (scene().geometry.dimension != allowed)
    refuse(fmt::format("geometry.dimension {}: OpenFOAM's case of a {} is {}; allowed: {}",
                       scenes::to_string(scene().geometry.dimension), folder(),
                       allowed == Dimension::plane  ? "a plane one"
                       : allowed == Dimension::half ? "one half, cut along its middle"
                                                    : "one quarter",
                       scenes::to_string(allowed)));
}

std::size_t Vessel::slices_along(std::size_t axis) const {
  std::set<long> places;
  for (const MeshCell& cell : mesh_cells(mesh())) places.insert(std::lround(1e6 * cell.centre()[axis]));
  return places.size();
}

int cells_over(double length, double cell) {
  return static_cast<int>(std::lround(std::clamp(length / cell, 1.0, most_cells)));
}

double estimated_over(double length, double cell) { return std::max(1.0, std::round(length / cell)); }

Line line_through(std::vector<double> places, double cell) {
  std::sort(places.begin(), places.end());
  places.erase(
      std::unique(places.begin(), places.end(), [](double a, double b) { return b - a < same_place; }),
      places.end());
  Line line{places, {}};
  for (std::size_t i = 1; i < places.size(); ++i)
    line.cells.push_back(cells_over(places[i] - places[i - 1], cell));
  return line;
}

double whole_over_mesh(const scenes::Scene& scene) {
  // A plane's mesh is one cell thick.
  const double thickness = scene.spatial_dimension() == 2 ? scene.foam.cell : 1.0;
  return scenes::pieces_of(scene).whole_over_computed / thickness;
}

}  // namespace flowrest::foam
