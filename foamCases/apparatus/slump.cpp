#include "foamCases/apparatus/slump.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "foamCases/concrete_laws.h"
#include "foamCases/function_object.h"
#include "foamCases/quarter_grid.h"
#include "foamCases/slump_sampler.h"
#include "foamCases/wedge_grid.h"

namespace flowrest::foam {

namespace {

/// Rows into which the lowest is cut with the plug-in.
constexpr int usual_base_rows = 4;

/// Height of the layer of thin rows with the plug-in, m: what the deposit is deep once it is slow. At the
/// surface, concrete's stress is shared between part-filled cells; the thinner they are the less that says. The
/// leading-order arrested slump, h = sqrt(2 tau0 (R - r) / (rho g)) (Yu et al. 2026, Eq. 51), is about a third
/// shallower in the middle than the slump is after a second.
double usual_base_height(const scenes::Scene& scene, const scenes::Slump& cone) {
  constexpr double deeper = 1.35;
  const double weight = scene.material.density * scene.forces.gravity;
  if (!(scene.material.yield_stress > 0.0) || !(weight > 0.0)) return 0.0;
  const double slope = 2.0 * scene.material.yield_stress / weight;  // of h^2
  const double radius = std::pow(15.0 * cone.volume() / (8.0 * std::numbers::pi * std::sqrt(slope)), 0.4);
  return std::min(deeper * std::sqrt(slope * radius), cone.cone_height);
}

/// A slump as a wedge about the vertical axis, or as a quarter.
class SlumpCase : public ApparatusCase {
 public:
  SlumpCase(const scenes::Slump& cone, const scenes::Scene& scene) : ApparatusCase(scene), cone_(cone) {}

  void check() const override {
    const auto dimension = scene().geometry.dimension;
    if (dimension != scenes::Dimension::axisymmetric && !is_quarter())
      refuse(fmt::format(
          "geometry.dimension {}: there is a slump case as a wedge and one as a quarter; allowed: "
          "axisymmetric, quarter",
          scenes::to_string(dimension)));
    cells();
  }
  std::size_t cells() const override {
    return is_quarter() ? quarter_grid(scene()).cells() : wedge_grid(scene()).cells();
  }
  std::size_t slices() const override {
    return static_cast<std::size_t>(is_quarter() ? quarter_grid(scene()).side : wedge_grid(scene()).rings);
  }
  double estimated_cells() const override {
    const double cell = scene().foam.cell, radius = std::ceil(cone_.domain_radius / cell);
    const double thin =
        scene().foam.base_height.value_or(is_quarter() ? 0.0 : usual_base_height(scene(), cone_));
    const double cut = std::max(1.0, std::round(thin / cell));
    const double rows = std::ceil(cone_.domain_height / cell) +
                        cut * ((scene().foam.base_rows == 0 ? usual_base_rows : scene().foam.base_rows) - 1);
    return rows * (is_quarter() ? radius * radius : radius);
  }
  bool steps_grow() const override { return true; }
  std::string folder() const override { return ApparatusCase::folder() + (is_quarter() ? "-quarter" : ""); }

  std::string mesh_parameters() const override { return is_quarter() ? quarter_mesh() : wedge_mesh(); }
  /// No utility of OpenFOAM cuts a quarter's cells by a cone.
  std::string initial_fraction() const override {
    if (!is_quarter()) return "";
    const auto grid = quarter_grid(scene());
    const auto fraction = cone_fraction(cone_, grid);
    std::string text = fmt::format("internalField   nonuniform List<scalar>\n{}\n(\n", grid.cells());
    for (std::size_t cell = 0; cell < fraction.size(); ++cell)
      text +=
          fmt::format("{}{}", fraction[cell], (cell + 1) % static_cast<std::size_t>(grid.side) ? " " : "\n");
    return text + ")";
  }
  std::vector<Utility> utilities() const override {
    if (is_quarter()) return {};
    return {{"setAlphaField"}, {"setFields"}};
  }
  /// Air that concrete spreads over must rise.
  std::string function_objects(bool plug_in) const override {
    const double rise_time = scene().foam.air_rise_time.value_or(0.0);
    if (!plug_in || !(rise_time > 0.0)) return "";
    return function_object("airRises", fmt::format("        time            {};  // s\n", rise_time));
  }
  std::string walls_differ() const override {
    return cone_.mould_lift_velocity ? "no mould: the cone is released at once" : "";
  }
  void settle(scenes::Foam& foam, bool plug_in) const override {
    constexpr double rise_time = 0.1;  // s
    if (foam.base_rows == 0) foam.base_rows = plug_in ? usual_base_rows : 1;
    if (!foam.base_height)
      foam.base_height =
          std::max(foam.cell, plug_in && !is_quarter() ? usual_base_height(scene(), cone_) : 0.0);
    if (!foam.air_rise_time) foam.air_rise_time = plug_in ? rise_time : 0.0;
  }

  std::unique_ptr<Sampler> sampler(CaseFields fields, runs::RunWriter& writer, bool plug_in) const override {
    return std::make_unique<SlumpSampler>(scene(), std::move(fields), writer, plug_in,
                                          plug_in && writes_shear_rate(*this));
  }

 private:
  bool is_quarter() const { return scene().geometry.dimension == scenes::Dimension::quarter; }

  std::string quarter_mesh() const {
    const auto grid = quarter_grid(scene());
    return fmt::format(
        "// Mesh, m: a quarter of the domain with cells of about {} m.\n"
        "coneHeight          {};\n"
        "domainRadius        {};\n"
        "domainHeight        {};\n"
        "sideCells           {};\n"
        "baseHeight          {};  // of a layer of thinner cells, which resolve the sheared base and the toe\n"
        "baseCells           {};\n"
        "coneCells           {};\n"
        "airCells            {};\n",
        scene().foam.cell, cone_.cone_height, cone_.domain_radius, cone_.domain_height, grid.side,
        grid.base_height(), grid.base_rows, grid.cone_rows, grid.air_rows);
  }

  std::string wedge_mesh() const {
    const auto grid = wedge_grid(scene());
    const double half_width =
        cone_.domain_radius * std::tan(0.5 * scene().foam.wedge_angle * std::numbers::pi / 180.0);
    return fmt::format(
        "// Mesh, m: a wedge of {} degrees with cells of about {} m.\n"
        "coneHeight          {};\n"
        "coneRadiusBottom    {};\n"
        "flankNormal         ({} 0 {});  // (height, 0, bottom radius - top radius)\n"
        "domainRadius        {};\n"
        "domainHeight        {};\n"
        "halfWidth           {};  // domainRadius tan(half angle)\n"
        "minusHalfWidth      {};\n"
        "radialCells         {};\n"
        "baseHeight          {};  // of a layer of thinner cells, which resolve the sheared base and the toe\n"
        "baseCells           {};\n"
        "coneCells           {};\n"
        "airCells            {};\n",
        scene().foam.wedge_angle, scene().foam.cell, cone_.cone_height, cone_.cone_radius_bottom,
        cone_.cone_height, cone_.cone_radius_bottom - cone_.cone_radius_top, cone_.domain_radius,
        cone_.domain_height, half_width, -half_width, grid.rings, grid.base_height(), grid.base_rows,
        grid.cone_rows, grid.air_rows);
  }

  const scenes::Slump& cone_;
};

}  // namespace

std::vector<double> cone_fraction(const scenes::Slump& cone, const QuarterGrid& grid) {
  // Gauss' rule with eight points resolves where the circle passes a cell's corner.
  static constexpr std::array<std::pair<double, double>, 4> rule{{{0.1834346424956498, 0.3626837833783620},
                                                                  {0.5255324099163290, 0.3137066458778873},
                                                                  {0.7966664774136267, 0.2223810344533745},
                                                                  {0.9602898564975363, 0.1012285362903763}}};
  std::vector<double> fraction(grid.cells(), 0.0);
  double below = 0.0;
  for (int row = 0; row < grid.base_rows + grid.cone_rows; ++row) {
    const double height = grid.row_height(row);
    for (const auto& [point, weight] : rule)
      for (const double sign : {-1.0, 1.0}) {
        const double z = below + 0.5 * height * (1.0 + sign * point);
        const double radius = std::lerp(cone.cone_radius_bottom, cone.cone_radius_top, z / cone.cone_height);
        for (int j = 0; j < grid.side; ++j)
          for (int i = 0; i < grid.side; ++i) {
            const auto corner = [&](int di, int dj) {
              return disc_in_rectangle(radius, (i + di) * grid.width, (j + dj) * grid.width);
            };
            const double area = corner(1, 1) - corner(0, 1) - corner(1, 0) + corner(0, 0);
            fraction[grid.index(i, j, row)] += 0.5 * weight * std::max(0.0, area) / (grid.width * grid.width);
          }
      }
    below += height;
  }
  for (double& f : fraction) f = f < 1e-12 ? 0.0 : f > 1.0 - 1e-12 ? 1.0 : f;
  return fraction;
}

std::unique_ptr<ApparatusCase> case_of(const scenes::Slump& cone, const scenes::Scene& scene) {
  return std::make_unique<SlumpCase>(cone, scene);
}

}  // namespace flowrest::foam
