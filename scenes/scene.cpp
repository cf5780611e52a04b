#include "scenes/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flowrest::scenes {

double SlumpGeometry::volume() const {
  return std::numbers::pi / 3.0 * cone_height *
         (cone_radius_top * cone_radius_top + cone_radius_top * cone_radius_bottom +
          cone_radius_bottom * cone_radius_bottom);
}

double VFunnelGeometry::width_at(double height) const {
  const double share = std::clamp((height - neck_height) / taper_height, 0.0, 1.0);
  return outlet_width + share * (top_width - outlet_width);
}

double VFunnelGeometry::volume() const {
  return depth * (neck_height * outlet_width + taper_height * 0.5 * (outlet_width + top_width));
}

double Scene::body_height() const {
  switch (kind) {
    case Kind::slump:
      return slump().cone_height;
    case Kind::duct:
      return duct().height;
    case Kind::l_box:
      return l_box().reservoir_height;
    case Kind::v_funnel:
      return v_funnel().height();
    case Kind::dam_break:
      return dam_break().column_height;
  }
  return 0.0;
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
