#include "compare/exact/duct.h"

#include <algorithm>
#include <cmath>
#include <vector>

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
  const auto [density, yield, viscosity, index] = before.material;
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
      const double rate = std::max(std::abs(trial) - yield, 0.0) / (viscosity + modulus * dt);
      stress[i] = trial - std::copysign(modulus * dt * rate, trial);
    }
  }
  return time;
}

}  // namespace flowrest::compare::exact
