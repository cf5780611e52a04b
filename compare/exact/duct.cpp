#include "compare/exact/duct.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "laws/elasto_viscoplastic.h"

namespace flowrest::compare::exact {

double profile_error(const runs::Profile& profile, double height,
                     const std::function<double(double)>& velocity) {
  // Profiles count y from the lower plate or from the middle.
  const double middle = profile.coordinate.front() < 0.0 ? 0.0 : 0.5 * height;
  double error = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < profile.value.size(); ++i) {
    const double u = velocity(profile.coordinate[i] - middle);
    error += (profile.value[i] - u) * (profile.value[i] - u);
    scale += u * u;
  }
  return std::sqrt(error / scale);
}

double duct_stopping_time(const DuctFlow& before, double driving, double slow) {
  constexpr int cells = 250;
  constexpr double modulus = 7e5, longest = 20.0;
  const double density = before.material.density;
  const laws::Parameters<double> law{before.material.yield_stress, before.material.plastic_viscosity, 0.0,
                                     0.0, before.material.flow_index};
  const double half = 0.5 * before.height, dy = half / cells, dt = 0.5 * dy / std::sqrt(modulus / density);
  std::vector<double> velocity, stress;  // from the wall
  for (int i = 0; i < cells; ++i) velocity.push_back(before.velocity(half - (i + 0.5) * dy));
  for (int i = 0; i <= cells; ++i) stress.push_back(before.force * (half - i * dy));
  double time = 0.0;
  for (; velocity.back() > slow && time < longest; time += dt) {
    for (std::size_t i = 0; i < velocity.size(); ++i)
      velocity[i] += dt / density * (driving + (stress[i + 1] - stress[i]) / dy);
    for (std::size_t i = 0; i + 1 < stress.size(); ++i) {
      const double gradient = i == 0 ? velocity[0] / (0.5 * dy) : (velocity[i] - velocity[i - 1]) / dy;
      const double trial = stress[i] + modulus * dt * gradient;
      const double kept =
          laws::ElastoViscoplastic::relax<double>(law, {std::abs(trial), modulus * dt}, 0.0).stress;
      stress[i] = std::copysign(kept, trial);
    }
  }
  return time;
}

}  // namespace flowrest::compare::exact
