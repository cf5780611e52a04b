#include "foamCases/step_rules.h"

#include <algorithm>
#include <cmath>

namespace flowrest::foam {

double largest_step(const ApparatusCase& apparatus) {
  const scenes::Scene& scene = apparatus.scene();
  if (scene.foam.max_time_step) return *scene.foam.max_time_step;
  constexpr double waves_over_cells = 1.5;
  const scenes::Material& material = scene.material;
  const double cell = apparatus.smallest_cell();
  double step = std::min(scene.output.history_interval, scene.output.profile_interval);
  if (laws::can_rest(material.model))
    return std::min(step, waves_over_cells * cell / std::sqrt(material.shear_modulus() / material.density));
  if (material.plastic_viscosity > 0.0)
    step = std::min(step, std::pow(cell, 2) * material.density / material.plastic_viscosity);
  return step;
}

double grown_step(const ApparatusCase& apparatus) {
  const scenes::Scene& scene = apparatus.scene();
  constexpr double of_sample = 0.4;
  const double step = largest_step(apparatus);
  if (!apparatus.steps_grow() || scene.foam.max_time_step || scene.foam.laws == scenes::FoamLaws::built_in)
    return step;
  const double interval = std::min(scene.output.history_interval, scene.output.profile_interval);
  return std::max(step, std::min(scene.foam.step_growth * step, of_sample * interval));
}

}  // namespace flowrest::foam
