#include "foamCases/rest_monitor.h"

#include <algorithm>
#include <cmath>

namespace flowrest::foam {

namespace {

constexpr double growth_per_overstress = 0.2;

/// Twice the time in which what drives the concrete moves it over its own height: at the start nothing shears
/// yet, and that is no rest. s
double time_to_trust_rest(const scenes::Scene& scene) {
  double driving = scene.forces.gravity;
  for (const auto& [time, force] : scene.forces.body_force)
    driving = std::max(driving, std::abs(force) / scene.material.density);
  const double length = scene.body_height();
  return driving > 0.0 ? 2.0 * std::sqrt(2.0 * length / driving) : 0.0;
}

}  // namespace

RestMonitor::RestMonitor(const scenes::Scene& scene)
    : can_rest_(laws::can_rest(scene.material.model) && scene.material.yield_stress > 0.0),
      stops_(scene.time.stop_at_rest),
      bound_(scene.time.rest_bound),
      patience_(time_to_trust_rest(scene)) {
  if (can_rest_)
    growth_per_rate_ = growth_per_overstress * scene.material.plastic_viscosity / scene.material.yield_stress;
}

void RestMonitor::add(double time, double shear_rate) {
  if (!can_rest_) return;
  time_ = time;
  growth_.reset();
  if (!std::isnan(shear_rate)) growth_ = growth_per_rate_ * shear_rate;
  if (!growth_ || !(*growth_ < bound_)) {
    calm_since_.reset();
  } else if (!calm_since_) {
    calm_since_ = time;
  }
}

std::optional<double> RestMonitor::rest_time() const {
  if (!calm_since_ || time_ - *calm_since_ < patience_) return std::nullopt;
  return calm_since_;
}

}  // namespace flowrest::foam
