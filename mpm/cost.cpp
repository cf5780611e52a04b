#include "mpm/cost.h"

#include "scenes/step_limits.h"

namespace flowrest::mpm {

namespace {

/// Particle-steps per CPU second, in double precision.
constexpr double particle_steps_per_cpu_second_2d = 1e7;
constexpr double particle_steps_per_cpu_second_3d = 4e6;
/// Memory held for one particle and one occupied cell in double precision; bytes.
constexpr double bytes_per_particle = 400.0;
constexpr double bytes_per_cell = 200.0;
/// Memory of a program that has nothing to do yet; bytes.
constexpr double bytes_of_solver = 2e7;

}  // namespace

scenes::Cost cost(const scenes::Scene& scene) {
  const scenes::MpmEstimate estimate = scenes::estimate_mpm(scene);
  const double number_size = scene.mpm.precision == scenes::Precision::single_precision ? 0.5 : 1.0;
  const double rate =
      scene.spatial_dimension() == 2 ? particle_steps_per_cpu_second_2d : particle_steps_per_cpu_second_3d;
  scenes::Cost cost;
  cost.memory = bytes_of_solver +
                number_size * (bytes_per_particle * estimate.particles + bytes_per_cell * estimate.cells);
  cost.cpu_seconds = estimate.particles * estimate.steps / rate;
  return cost;
}

}  // namespace flowrest::mpm
