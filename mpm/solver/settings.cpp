#include "mpm/solver/settings.h"

#include <cmath>
#include <limits>

#include "mpm/boundary/scene_walls.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

namespace {

double density_correction(const scenes::Scene& scene, const scenes::Pieces& pieces) {
  const auto& mpm = scene.mpm;
  if (mpm.scheme == scenes::Scheme::paper) return 0.0;
  // Where there is no free surface to make room at, particles would only shrink, and with them what resists.
  // Nor is there one in a neck that runs full; and in the heap under it, into which a jet drives particles,
  // pressure would make more energy than it may.
  const bool left_alone = !pieces.free_surface || pieces.runs_out;
  const double usual = mpm.scheme == scenes::Scheme::quadratic_apic ? 1.0 : 0.3;
  return mpm.density_correction.value_or(left_alone ? 0.0 : usual);
}

Nozzle nozzle_of(const scenes::Feed& feed) {
  return {.bore = feed.bore,
          .wall = feed.wall,
          .mouth = feed.mouth,
          .extruded = feed.extruded,
          .column = feed.column,
          .begins_at = feed.begins_at,
          .gone_at = feed.gone_at};
}

}  // namespace

double cell_size(const scenes::Scene& scene) {
  const scenes::Pieces pieces = scenes::pieces_of(scene);
  const double wanted = scene.mpm.cell;
  if (const auto height = pieces.whole_cells_over)
    return *height / std::max(1.0, std::round(*height / wanted));
  if (const auto height = pieces.half_cells_over) return scenes::cell_with_half(*height, wanted);
  return wanted;
}

double whole_body_factor(const scenes::Scene& scene) { return scenes::pieces_of(scene).whole_over_computed; }

std::array<double, 3> acceleration_at(const scenes::Scene& scene, double time) {
  std::array<double, 3> a{};
  a[static_cast<std::size_t>(vertical_axis(scene))] = -scene.forces.gravity;
  if (!scene.forces.body_force.empty()) a[0] = scene.forces.body_force_at(time) / scene.material.density;
  return a;
}

SolverSettings settings_of(const scenes::Scene& scene) {
  const auto& m = scene.material;
  const scenes::Pieces pieces = scenes::pieces_of(scene);
  SolverSettings s;
  s.dimension = scene.spatial_dimension();
  s.axisymmetric = scene.geometry.dimension == scenes::Dimension::axisymmetric;
  const bool paper = scene.mpm.scheme == scenes::Scheme::paper;
  s.transfer =
      scene.mpm.scheme == scenes::Scheme::quadratic_apic ? Transfer::quadratic_apic : Transfer::linear_flip;
  // Volume that walls hold all around gains nothing by being averaged through the nodes (docs/measured,
  // smooth B-bar).
  if (!pieces.free_surface) s.dilatation = Dilatation::cell_average;
  if (paper) s.dilatation = Dilatation::centroid;
  if (scene.mpm.b_bar)
    s.dilatation = *scene.mpm.b_bar == scenes::BBar::smooth ? Dilatation::smooth : Dilatation::cell_average;
  s.stress_rate = paper ? StressRate::jaumann : StressRate::hughes_winget;
  s.law = m.model;
  s.explicit_fluid =
      !laws::can_rest(m.model) && scene.mpm.fluid_update == scenes::FluidUpdate::explicit_update;
  s.single_precision = scene.mpm.precision == scenes::Precision::single_precision;
  s.cell = cell_size(scene);
  s.density = m.density;
  // Yu et al. name FLIP alone, which keeps all of a particle's own velocity.
  s.flip_relaxation_time = paper ? std::numeric_limits<double>::infinity() : scene.mpm.flip_relaxation_time;
  s.density_correction = density_correction(scene, pieces);
  s.free_surface = pieces.free_surface;
  s.flow = m.flow_curve().parameters;
  if (!laws::has_yield_stress(m.model)) s.flow.yield_stress = 0.0;
  s.thixotropic = scene.thixotropy.has_value() && laws::has_yield_stress(m.model);
  if (s.thixotropic) {
    s.structure = scene.thixotropy->structure(m.yield_stress);
    s.ageing = scene.thixotropy->ageing();
  }
  s.state = {m.bulk_modulus(), m.shear_modulus(), m.equation_of_state_exponent};
  const SceneWalls walls = walls_of(pieces, s.dimension, s.cell);
  s.bounds = walls.bounds;
  s.walls = walls.walls;
  for (const scenes::Feed& feed : pieces.feeds) s.nozzles.push_back(nozzle_of(feed));
  s.threads = scene.mpm.threads;
  return s;
}

}  // namespace flowrest::mpm
