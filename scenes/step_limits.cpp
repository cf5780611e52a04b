#include "scenes/step_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenes/pieces.h"

namespace flowrest::scenes {

namespace {

/// K / K0 under a pressure. From Yu et al. 2026, Eq. 6, p = K0 / gamma (exp(-gamma e) - 1), so the tangent is
/// K = K0 + gamma p.
double stiffening(const Material& material, double pressure) {
  return 1.0 + material.equation_of_state_exponent * pressure / material.bulk_modulus();
}

/// Yield stress that thixotropy can reach by the end of a run: Yu et al. 2026, Eqs. 11 and 12 without
/// breakdown, and growth with age.
double largest_yield_stress(const Scene& scene) {
  const double tau0 = scene.material.yield_stress;
  if (!scene.thixotropy) return tau0;
  return tau0 * (1.0 + scene.thixotropy->initial_flocculation) +
         scene.thixotropy->flocculation_rate * scene.time.end + scene.grown_yield_stress(scene.time.end);
}

/// Largest viscosity that the scene's law can have by the end of a run.
double largest_viscosity(const Scene& scene) {
  laws::FlowCurve curve = scene.material.flow_curve();
  curve.parameters.yield_stress = largest_yield_stress(scene);
  return curve.largest_viscosity();
}

/// dt < density cell^2 / (6 eta_max): past it the capped stress chatters silently instead of blowing up.
double viscous_limit(const Scene& scene) {
  const bool is_explicit_fluid =
      !laws::can_rest(scene.material.model) && scene.mpm.fluid_update == FluidUpdate::explicit_update;
  const double viscosity = largest_viscosity(scene);
  if (!is_explicit_fluid || viscosity <= 0.0) return std::numeric_limits<double>::infinity();
  return scene.material.density * scene.mpm.cell * scene.mpm.cell / (6.0 * viscosity);
}

/// Largest stable Courant number as measured: 1.15 to a Poisson ratio of 0.3, falling to 1.0 at 0.49.
double largest_courant_number(double poisson_ratio) {
  const double nearly_incompressible = std::clamp((poisson_ratio - 0.3) / (0.49 - 0.3), 0.0, 1.0);
  return std::lerp(1.15, 1.0, nearly_incompressible);
}

}  // namespace

double StepLimits::largest() const { return std::min(largest_cfl * acoustic, viscous); }

double free_fall_speed(const Scene& scene) {
  return std::sqrt(2.0 * scene.forces.gravity * pieces_of(scene).drop);
}

double pressure_at_rest(const Scene& scene) {
  return scene.material.density * scene.forces.gravity * scene.body_height();
}

double volume_under_weight(const Scene& scene) {
  // exp(e) from K / K0 = exp(-gamma e)
  return std::pow(stiffening(scene.material, pressure_at_rest(scene)),
                  -1.0 / scene.material.equation_of_state_exponent);
}

StepLimits step_limits(const Scene& scene) {
  StepLimits limits;
  // The shear modulus scales with K, so the speed of longitudinal waves grows with the root of the
  // stiffening.
  const double speed =
      scene.material.longitudinal_speed() * std::sqrt(stiffening(scene.material, pressure_at_rest(scene)));
  limits.acoustic = scene.mpm.cell / speed;
  limits.viscous = viscous_limit(scene);
  limits.largest_cfl = largest_courant_number(scene.material.poisson_ratio);
  return limits;
}

namespace {

double occupied_cells(const Scene& scene) {
  double extent = 0.0;
  const Pieces pieces = pieces_of(scene);
  for (const Body& body : pieces.bodies) extent += body.extent;
  for (const Feed& feed : pieces.feeds) {
    const double column = std::min(feed.column, feed.extruded(std::min(feed.gone_at, scene.time.end)));
    extent += std::numbers::pi * feed.bore * feed.bore * column / pieces.whole_over_computed;
  }
  return extent / std::pow(scene.mpm.cell, scene.spatial_dimension());
}

}  // namespace

MpmEstimate estimate_mpm(const Scene& scene) {
  MpmEstimate estimate;
  constexpr double round_off = 1e-9;
  estimate.cells = std::max(1.0, std::ceil(occupied_cells(scene) * (1.0 - round_off)));
  estimate.particles = estimate.cells;
  for (const int along_an_axis : scene.mpm.particles_per_cell) estimate.particles *= along_an_axis;
  const StepLimits limits = step_limits(scene);
  estimate.step = scene.mpm.time_step.value_or(std::min(scene.mpm.cfl * limits.acoustic, limits.viscous));
  estimate.steps = std::max(1.0, std::ceil(scene.time.end / estimate.step));
  return estimate;
}

}  // namespace flowrest::scenes
