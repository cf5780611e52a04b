#include "scenes/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/step_limits.h"

namespace flowrest::scenes {

namespace {

/// Particle-steps per CPU second, in double precision.
constexpr double particle_steps_per_cpu_second_2d = 1e7;
constexpr double particle_steps_per_cpu_second_3d = 4e6;
/// Cell-steps per CPU second of interFoam with the plug-in: 16,407 steps of 1,710 cells took 361 s.
constexpr double cell_steps_per_cpu_second = 7e4;

/// Cells that the mesh of an L-box has more than its cell asks for, along and across, for its bars.
constexpr double cells_of_bars_along = 4.0, cells_of_bars_across = 5.0;

/// Memory held for one particle and one occupied cell in double precision, and for one cell of an OpenFOAM
/// mesh; bytes.
constexpr double bytes_per_particle = 400.0;
constexpr double bytes_per_cell = 200.0;
constexpr double bytes_per_mesh_cell = 2000.0;
/// Memory of a program that has nothing to do yet; bytes.
constexpr double bytes_of_solver = 2e7;
constexpr double bytes_of_interfoam = 1e8;

/// Cells of the mesh of an OpenFOAM case; of vessels to some 20 %, as a mesh is laid out by its own room.
double mesh_cells(const Scene& scene) {
  const double cell = scene.foam.cell;
  const auto along = [cell](double length) { return std::max(1.0, std::round(length / cell)); };
  switch (scene.kind()) {
    case Kind::duct:
      return std::round(scene.duct().height / cell);
    case Kind::slump: {
      const Slump& shape = scene.slump();
      // The usual four rows in place of the lowest.
      const double rows =
          std::ceil(shape.domain_height / cell) + (scene.foam.base_rows == 0 ? 4 : scene.foam.base_rows) - 1;
      const double radius = std::ceil(shape.domain_radius / cell);
      return rows * (scene.geometry.dimension == Dimension::quarter ? radius * radius : radius);
    }
    case Kind::l_box: {
      const LBox& box = scene.l_box();
      const double bars = box.rebars > 0 ? 1.0 : 0.0;
      const double channel =
          (along(box.length()) + bars * cells_of_bars_along) * (along(box.channel_height) + 2.0);
      const double reservoir = along(box.reservoir_length) * along(box.reservoir_height - box.channel_height);
      return (along(0.5 * box.width) + bars * cells_of_bars_across) * (channel + reservoir);
    }
    case Kind::v_funnel: {
      const VFunnel& funnel = scene.v_funnel();
      return along(0.5 * std::sqrt(funnel.outlet_width * funnel.top_width)) * along(0.5 * funnel.depth) *
             (along(funnel.height()) + 5.0);
    }
    case Kind::dam_break: {
      const DamBreak& dam = scene.dam_break();
      return along(dam.tank_length) * along(2.0 * dam.column_height);
    }
  }
  return 0.0;
}

/// Steps of a slump's OpenFOAM run, the few of the fall that the Courant number shortens aside.
double unhurried_foam_steps(const Scene& scene) {
  const double first = largest_foam_step(scene), most = grown_foam_step(scene), end = scene.time.end;
  const double grows = first / foam_step_of_time, grown = most / foam_step_of_time;
  if (most <= first || end <= grows) return end / first;
  return grows / first + std::log(std::min(end, grown) / grows) / foam_step_of_time +
         std::max(end - grown, 0.0) / most;
}

/// Steps of an OpenFOAM run. Out of a funnel concrete falls, and air behind it, for as long as the run lasts,
/// and leaves the mesh shortly below the outlet. What passes between an L-box's bars, where cells are
/// smallest, does so at a share of the fall's speed that was measured of the elasto-viscoplastic law; a
/// fluid's steps are smaller than that asks for.
double foam_steps(const Scene& scene) {
  const double unhurried = unhurried_foam_steps(scene);
  constexpr double between_bars = 0.15;
  double speed = std::sqrt(2.0 * scene.forces.gravity * scene.body_height());
  if (scene.kind() == Kind::l_box && laws::can_rest(scene.material.model))
    speed *= between_bars;
  else if (scene.kind() != Kind::v_funnel)
    return unhurried;
  return std::max(unhurried, scene.time.end * speed / (scene.foam.max_courant * smallest_foam_cell(scene)));
}

}  // namespace

std::string bytes_in_words(double count) {
  return count < 1e9 ? fmt::format("{:.3g} MB", count / 1e6) : fmt::format("{:.3g} GB", count / 1e9);
}

Cost mpm_cost(const Scene& scene) {
  const MpmEstimate estimate = estimate_mpm(scene);
  const double number_size = scene.mpm.precision == Precision::single_precision ? 0.5 : 1.0;
  const double rate =
      scene.spatial_dimension() == 2 ? particle_steps_per_cpu_second_2d : particle_steps_per_cpu_second_3d;
  Cost cost;
  cost.memory = bytes_of_solver +
                number_size * (bytes_per_particle * estimate.particles + bytes_per_cell * estimate.cells);
  cost.cpu_seconds = estimate.particles * estimate.steps / rate;
  return cost;
}

FoamEstimate estimate_foam(const Scene& scene) {
  FoamEstimate estimate;
  estimate.cells = mesh_cells(scene);
  estimate.step = grown_foam_step(scene);
  estimate.steps = std::max(1.0, std::ceil(foam_steps(scene)));
  estimate.cost.memory = bytes_of_interfoam + bytes_per_mesh_cell * estimate.cells;
  estimate.cost.cpu_seconds =
      scene.foam.outer_correctors * estimate.cells * estimate.steps / cell_steps_per_cpu_second;
  return estimate;
}

}  // namespace flowrest::scenes
