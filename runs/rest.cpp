#include "runs/rest.h"

#include <algorithm>
#include <cmath>

#include "runs/depth.h"

namespace flowrest::runs {

namespace {

/// D ~ tau0^(-1/5): leading-order slumps about an axis.
constexpr double growth_per_overstress = 0.2;

}  // namespace

Rest::Rest(const scenes::Scene& scene)
    : stops_(scene.time.stop_at_rest),
      bound_(scene.time.rest_bound),
      height_(scene.body_height()),
      gravity_(scene.forces.gravity),
      density_(scene.material.density),
      body_force_(scene.forces.body_force) {
  const auto& material = scene.material;
  if (laws::can_rest(material.model) && material.yield_stress > 0.0)
    viscosity_over_yield_ = material.plastic_viscosity / material.yield_stress;
  flow_index_ = material.flow_index;
}

double Rest::patience(double time) const {
  double driving = gravity_, most = gravity_;
  for (const auto& [from, force] : body_force_) {
    const double acceleration = std::abs(force) / density_;
    if (from <= time) driving = std::max(gravity_, acceleration);
    most = std::max(most, acceleration);
  }
  // Where nothing drives any more, what moves was brought about by what has.
  if (driving == 0.0) driving = most;
  return driving > 0.0 ? 2.0 * std::sqrt(2.0 * height_ / driving) : 0.0;
}

double Rest::last_change_of_force(double time) const {
  double last = 0.0;
  for (const auto& [from, force] : body_force_)
    if (from <= time) last = from;
  return last;
}

void Rest::add(double time, double overstress) {
  if (!can_rest()) return;
  time_ = time;
  growth_.reset();
  if (!std::isnan(overstress)) growth_ = growth_per_overstress * overstress;
  if (!growth_ || !(*growth_ < bound_)) {
    calm_since_.reset();
  } else if (!calm_since_ || *calm_since_ < last_change_of_force(time)) {
    calm_since_ = time;
  }
}

void Rest::restore(double time, std::optional<double> calm_since) {
  time_ = time;
  calm_since_ = calm_since;
}

std::optional<double> Rest::rest_time() const {
  if (!calm_since_ || time_ - *calm_since_ < patience(time_)) return std::nullopt;
  return calm_since_;
}

}  // namespace flowrest::runs
