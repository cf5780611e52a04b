#include "compare/exact/solutions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "runs/depth.h"

namespace flowrest::compare::exact {

using std::numbers::pi;

double ArrestedSlump::depth(double r) const {
  if (r > radius) return 0.0;
  return nose + std::sqrt(nose * nose + 2.0 * length * (radius - r));
}

double ArrestedSlump::volume() const {
  // 2 pi int r h dr with w = a^2 + 2 l (R - r) in place of r.
  const double slope = 2.0 * length;
  const double inner = nose * nose + slope * radius;
  const double thirds = 2.0 / 3.0 * (std::pow(inner, 1.5) - std::pow(nose, 3.0));
  const double fifths = 2.0 / 5.0 * (std::pow(inner, 2.5) - std::pow(nose, 5.0));
  return pi * radius * radius * nose + 2.0 * pi / (slope * slope) * (inner * thirds - fifths);
}

double ArrestedSlump::spread(double threshold) const {
  if (threshold >= depth(0.0)) return runs::nothing;
  const double over_nose = std::max(0.0, threshold - nose);
  return 2.0 * (radius - std::max(0.0, over_nose * over_nose - nose * nose) / (2.0 * length));
}

ArrestedSlump leading_order_slump(const Bingham& material, double gravity, double volume) {
  const double length = material.yield_stress / (material.density * gravity);
  // Yu et al. 2026, Eq. 51.
  return {length, 0.0, std::pow(225.0 * volume * volume / (128.0 * pi * pi * length), 0.2)};
}

ArrestedSlump second_order_slump(const Bingham& material, double gravity, double volume) {
  ArrestedSlump slump = leading_order_slump(material, gravity, volume);
  slump.nose = plug_pull * slump.length;
  // The volume grows with the radius, and the nose only shortens the slump: bisection between 0 and the
  // leading order.
  double low = 0.0, high = slump.radius;
  for (int i = 0; i < 200 && low < high; ++i) {
    slump.radius = 0.5 * (low + high);
    (slump.volume() < volume ? low : high) = slump.radius;
  }
  return slump;
}

double ArrestedPlaneSlump::depth(double x) const {
  return std::abs(x) > half_width ? 0.0 : std::sqrt(2.0 * length * (half_width - std::abs(x)));
}

double ArrestedPlaneSlump::half_area() const {
  return 2.0 / 3.0 * std::sqrt(2.0 * length) * std::pow(half_width, 1.5);
}

double ArrestedPlaneSlump::spread(double threshold) const {
  if (threshold >= depth(0.0)) return runs::nothing;
  return 2.0 * (half_width - threshold * threshold / (2.0 * length));
}

ArrestedPlaneSlump plane_slump(const Bingham& material, double gravity, double half_area) {
  const double length = material.yield_stress / (material.density * gravity);
  return {length, std::cbrt(9.0 * half_area * half_area / (8.0 * length))};
}

double DuctFlow::plug_half_width() const {
  return force > 0.0 ? std::min(0.5 * height, material.yield_stress / force) : 0.5 * height;
}

double DuctFlow::velocity(double y) const {
  const double outer = std::clamp(std::abs(y), plug_half_width(), 0.5 * height);
  const auto& [density, yield, consistency, index] = material;
  const auto stress_past_yield = [&](double from_middle) {
    return std::max(force * from_middle - yield, 0.0);
  };
  // (1/F) times the integral of the rate ((tau - tau0) / K)^(1/n) over the stress from here to the wall.
  const auto integral = [&](double stress) {
    return stress * std::pow(stress / consistency, 1.0 / index) * index / (index + 1.0);
  };
  return force > 0.0
             ? (integral(stress_past_yield(0.5 * height)) - integral(stress_past_yield(outer))) / force
             : 0.0;
}

double DuctFlow::plug_velocity() const { return velocity(0.0); }

// Outside the plug the velocity is plug_velocity (1 - s^(1 + 1/n)), s from 0 at the plug to 1 at the wall.
double DuctFlow::mean_velocity() const {
  const double plug = 2.0 * plug_half_width() / height;
  const double n = material.flow_index;
  return plug_velocity() * (plug + (1.0 - plug) * (n + 1.0) / (2.0 * n + 1.0));
}

double DuctFlow::l2_norm() const {
  const double plug = 2.0 * plug_half_width();
  const double power = 1.0 + 1.0 / material.flow_index;
  const double share = 1.0 - 2.0 / (power + 1.0) + 1.0 / (2.0 * power + 1.0);
  return plug_velocity() * std::sqrt(plug + (height - plug) * share);
}

double stopping_time_bound(const Bingham& material, double height, double force, double l2_norm) {
  const double a = material.flow_index == 1.0
                       ? pi * pi * material.plastic_viscosity / (material.density * height * height)
                       : 0.0;
  const double b =
      2.0 * (material.yield_stress - 0.5 * std::abs(force) * height) / (material.density * std::sqrt(height));
  if (!(b > 0.0)) return std::numeric_limits<double>::infinity();
  return a > 0.0 ? std::log1p(a * l2_norm / b) / a : l2_norm / b;
}

}  // namespace flowrest::compare::exact
