#include "scenes/scene.h"

#include <algorithm>
#include <cmath>

namespace flowrest::scenes {

double Gauges::edge_depth(MainGauge gauge) const {
  switch (gauge) {
    case MainGauge::spread:
      return spread_depth;
    case MainGauge::front:
      return front_depth;
    case MainGauge::discharge:
      return light_depth;
    case MainGauge::velocity:
    case MainGauge::section:
      break;
  }
  return Gauges{}.spread_depth;
}

Gauges gauges_of_body(const Scene& scene) {
  constexpr double standard_gravity = 9.81;  // m/s2
  Gauges gauges;
  const double standard =
      std::visit([](const auto& a) { return a.standard_height; }, scene.geometry.apparatus);
  if (standard == 0.0) return gauges;
  const double height = scene.body_height();
  const double size = height / standard;
  const double time =
      scene.forces.gravity > 0.0 ? std::sqrt(size * (standard_gravity / scene.forces.gravity)) : 1.0;
  if (scene.main_gauge() == MainGauge::spread) {
    gauges.spread_depth = height / 100.0;
  } else {
    gauges.front_depth = gauges.light_depth = height / 200.0;
    gauges.end_length = height / 30.0;
  }
  // However odd a body is, they stay in the range of their keys.
  const auto scaled = [](double value, double by) { return std::clamp(value * by, 1e-9, 1e3); };
  gauges.rest_rate = scaled(gauges.rest_rate, size / time);
  gauges.still_speed = scaled(gauges.still_speed, size / time);
  gauges.rest_shear_rate = scaled(gauges.rest_shear_rate, 1.0 / time);
  gauges.rate_window = scaled(gauges.rate_window, time);
  return gauges;
}

MainGauge Scene::main_gauge() const { return main_gauge_of(geometry.apparatus); }

double Scene::grown_yield_stress(double when) const {
  return thixotropy && laws::has_yield_stress(material.model) ? thixotropy->ageing().grown(when) : 0.0;
}

double Scene::body_height() const {
  return std::visit([](const auto& a) { return a.body_height(); }, geometry.apparatus);
}

double Scene::body_size() const {
  return std::visit([](const auto& a) { return a.body_size(); }, geometry.apparatus);
}

double Material::bulk_modulus() const { return youngs_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio)); }

double Material::shear_modulus() const { return youngs_modulus / (2.0 * (1.0 + poisson_ratio)); }

double Material::longitudinal_speed() const {
  return std::sqrt((bulk_modulus() + 4.0 / 3.0 * shear_modulus()) / density);
}

bool Material::has(laws::Parameter parameter) const {
  switch (parameter) {
    case laws::Parameter::regularisation_time:
      return regularisation_time.has_value();
    case laws::Parameter::critical_shear_rate:
      return critical_shear_rate.has_value();
    default:
      return true;
  }
}

bool Material::suits(Model law) const {
  return std::all_of(std::begin(laws::every_parameter), std::end(laws::every_parameter),
                     [&](laws::Parameter p) { return !laws::needs(law, p) || has(p); });
}

laws::FlowCurve Material::flow_curve() const {
  return {model,
          {yield_stress, plastic_viscosity, regularisation_time.value_or(0.0),
           critical_shear_rate.value_or(1.0), flow_index}};
}

double Forces::body_force_at(double time) const {
  double force = 0.0;
  for (const auto& [from, value] : body_force) {
    if (time >= from) force = value;
  }
  return force;
}

}  // namespace flowrest::scenes
