#include "scenes/scene.h"

#include <cmath>
#include <numbers>

namespace flowrest::scenes {

double SlumpGeometry::volume() const {
  return std::numbers::pi / 3.0 * cone_height *
         (cone_radius_top * cone_radius_top + cone_radius_top * cone_radius_bottom +
          cone_radius_bottom * cone_radius_bottom);
}

double Material::bulk_modulus() const { return youngs_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)); }

double Material::shear_modulus() const { return youngs_modulus / (2.0 * (1.0 + poisson_ratio)); }

double Material::longitudinal_speed() const {
  return std::sqrt((bulk_modulus() + 4.0 / 3.0 * shear_modulus()) / density);
}

double Forces::body_force_at(double time) const {
  double force = 0.0;
  for (const auto& [from, value] : body_force) {
    if (time >= from) force = value;
  }
  return force;
}

}  // namespace flowrest::scenes
