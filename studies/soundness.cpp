#include "studies/soundness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runs/gauges.h"
#include "scenes/pieces.h"
#include "scenes/step_limits.h"

namespace flowrest::studies {

namespace {

constexpr double energy_made_allowed = 0.05;  // of the largest energy the run has seen
constexpr double mass_drift_allowed = 1e-6;   // float, summed in double
constexpr double tension_allowed = 0.02;      // of the volume: a free fall's swing
constexpr double speed_slack = 1.5;

const std::vector<double>* column(const runs::Run& run, const std::string& name) {
  return run.history.has(name) ? &run.history.at(name) : nullptr;
}

std::string not_finite(const runs::Run& run) {
  for (std::size_t c = 0; c < run.history.names.size(); ++c)
    for (const double v : run.history.columns[c])
      if (!std::isfinite(v) && !(std::isnan(v) && runs::may_read_nothing(run.history.names[c])))
        return fmt::format("{} is not finite", run.history.names[c]);
  for (const auto& profile : run.profiles)
    for (const double v : profile.value)
      if (!std::isfinite(v)) return fmt::format("the profile at {:g} s is not finite", profile.time);
  return {};
}

std::string mass_lost(const runs::Run& run) {
  const auto* volume = column(run, "volume_at_rest_m3");
  if (!volume || volume->empty()) return {};
  for (const double v : *volume)
    if (std::abs(v - volume->front()) > mass_drift_allowed * volume->front())
      return fmt::format("the mass changes by {:.2g} of itself", v / volume->front() - 1.0);
  return {};
}

/// An MPM run's volume follows from its pressure; other solvers are held to their own conservation elsewhere.
std::string volume_wrong(const runs::Run& run, const scenes::Scene& scene) {
  const auto *volume = column(run, "volume_m3"), *at_rest = column(run, "volume_at_rest_m3");
  if (!volume || !at_rest || volume->empty()) return {};
  // A column that lands presses twice as hard as one that stands.
  const double least = 1.0 - 2.0 * (1.0 - scenes::volume_under_weight(scene)) - tension_allowed;
  for (std::size_t i = 0; i < volume->size(); ++i) {
    const double ratio = (*volume)[i] / (*at_rest)[i];
    if (ratio < least || ratio > 1.0 + tension_allowed)
      return fmt::format("at {:g} s the volume is {:.3f} of that at rest; its weight allows {:.3f} to {:.3f}",
                         run.history.at("time_s")[i], ratio, least, 1.0 + tension_allowed);
  }
  return {};
}

std::string energy_made(const runs::Run& run) {
  const auto *numerical = column(run, "numerical_energy_J"), *kinetic = column(run, "kinetic_energy_J"),
             *potential = column(run, "potential_energy_J"), *dissipated = column(run, "dissipated_energy_J");
  if (!numerical || !kinetic || !potential || !dissipated || numerical->empty()) return {};
  double scale = 0.0;
  for (std::size_t i = 0; i < numerical->size(); ++i)
    scale =
        std::max({scale, (*kinetic)[i], std::abs((*potential)[i] - potential->front()), (*dissipated)[i]});
  scale = std::max(scale, std::abs(potential->front()));
  for (std::size_t i = 0; i < numerical->size(); ++i)
    if ((*numerical)[i] < -energy_made_allowed * scale)
      return fmt::format("at {:g} s the discretisation has made energy: {:.2g} J of {:.2g} J",
                         run.history.at("time_s")[i], -(*numerical)[i], scale);
  return {};
}

std::string flocculation_negative(const runs::Run& run) {
  const auto* lambda = column(run, "flocculation_mean");
  if (lambda)
    for (const double v : *lambda)
      if (v < 0.0) return fmt::format("the flocculation is {:.2g}", v);
  return {};
}

/// Nothing that weight alone drives moves faster, in the mean over its mass, than what falls from its height.
std::string too_fast(const runs::Run& run, const scenes::Scene& scene) {
  const auto *kinetic = column(run, "kinetic_energy_J"), *volume = column(run, "volume_at_rest_m3");
  if (!scene.forces.body_force.empty() || !kinetic || !volume || volume->empty()) return {};
  const double fall = scenes::free_fall_speed(scene);
  for (std::size_t i = 0; i < kinetic->size(); ++i) {
    const double speed = std::sqrt(2.0 * (*kinetic)[i] / (scene.material.density * (*volume)[i]));
    if (speed > speed_slack * fall + 1e-12)
      return fmt::format(
          "its root mean square speed is {:.3g} m/s; a fall from its height ends at {:.3g} m/s", speed, fall);
  }
  return {};
}

std::string beyond_the_domain(const runs::Run& run, const scenes::Scene& scene) {
  const auto* spread = column(run, "spread_mm");
  const auto domain = scenes::pieces_of(scene).domain;
  if (!domain || !spread) return {};
  for (const double v : *spread)
    if (1e-3 * v > 2.0 * domain->radius * 1.05)
      return fmt::format("its spread of {:.3g} mm lies beyond the domain", v);
  return {};
}

}  // namespace

std::string unsound(const runs::Run& run, const scenes::Scene& scene) {
  for (const std::string& found :
       {not_finite(run), mass_lost(run), volume_wrong(run, scene), energy_made(run),
        flocculation_negative(run), too_fast(run, scene), beyond_the_domain(run, scene)})
    if (!found.empty()) return found;
  return {};
}

}  // namespace flowrest::studies
