#include "scenes/cost.h"

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

/// Memory held for one particle and one occupied cell in double precision, and for one cell of an OpenFOAM
/// mesh; bytes.
constexpr double bytes_per_particle = 400.0;
constexpr double bytes_per_cell = 200.0;
constexpr double bytes_per_mesh_cell = 2000.0;
/// Memory of a program that has nothing to do yet; bytes.
constexpr double bytes_of_solver = 2e7;
constexpr double bytes_of_interfoam = 1e8;

}  // namespace

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
  const double cell = scene.foam.cell;
  FoamEstimate estimate;
  if (scene.kind == Kind::duct) {
    estimate.cells = std::round(scene.duct().height / cell);
  } else if (scene.kind == Kind::slump) {
    const SlumpGeometry& shape = scene.slump();
    // The usual four rows in place of the lowest.
    const double rows =
        std::ceil(shape.domain_height / cell) + (scene.foam.base_rows == 0 ? 4 : scene.foam.base_rows) - 1;
    const double along = std::ceil(shape.domain_radius / cell);
    estimate.cells = rows * (scene.geometry.dimension == Dimension::quarter ? along * along : along);
  }
  estimate.step = largest_foam_step(scene);
  estimate.steps = std::max(1.0, std::ceil(scene.time.end / estimate.step));
  estimate.cost.memory = bytes_of_interfoam + bytes_per_mesh_cell * estimate.cells;
  estimate.cost.cpu_seconds =
      scene.foam.outer_correctors * estimate.cells * estimate.steps / cell_steps_per_cpu_second;
  return estimate;
}

}  // namespace flowrest::scenes
