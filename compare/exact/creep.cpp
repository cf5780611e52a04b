#include "compare/exact/creep.h"

#include <algorithm>
#include <cmath>

namespace flowrest::compare::exact {

namespace {

/// int_0^{tau(last)} weight(tau, g) dtau along the flow curve, by trapezia in the shear rate, where it is
/// smooth.
template <class Weight>
double along_the_flow_curve(const RegularisedFluid& fluid, double last_shear_rate, Weight weight) {
  constexpr int panels = 20000;
  double sum = 0.0, stress = 0.0, value = weight(0.0, 0.0);
  for (int i = 1; i <= panels; ++i) {
    const double rate = last_shear_rate * i / panels;
    const double next_stress = fluid.stress(rate);
    const double next_value = weight(next_stress, rate);
    sum += 0.5 * (value + next_value) * (next_stress - stress);
    stress = next_stress;
    value = next_value;
  }
  return sum;
}

}  // namespace

double RegularisedFluid::stress(double rate) const {
  if (law == Law::bi_viscous)
    return std::min(largest_viscosity() * rate, yield_stress + plastic_viscosity * rate);
  return plastic_viscosity * rate - yield_stress * std::expm1(-regularisation_time * rate);
}

double RegularisedFluid::shear_rate(double wanted) const {
  if (law == Law::bi_viscous)
    return wanted <= largest_viscosity() / std::max(regularisation_time, 1e-300)
               ? wanted / largest_viscosity()
               : (wanted - yield_stress) / plastic_viscosity;
  // The flow curve is concave, so Newton's steps from zero approach the root from below and never pass it.
  double rate = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double slope =
        plastic_viscosity + regularisation_time * yield_stress * std::exp(-regularisation_time * rate);
    const double step = (wanted - stress(rate)) / slope;
    rate += step;
    if (std::abs(step) <= 1e-14 * rate) break;
  }
  return rate;
}

double film_velocity(const RegularisedFluid& fluid, double depth, double base_stress) {
  if (!(base_stress > 0.0)) return 0.0;
  return depth / (base_stress * base_stress) *
         along_the_flow_curve(fluid, fluid.shear_rate(base_stress),
                              [](double tau, double g) { return tau * g; });
}

double spread_creep(const RegularisedFluid& fluid, double arrested_radius, double depth_at_half_radius,
                    double radius) {
  const double past = std::min(1.0, arrested_radius / radius);
  return 4.0 *
         film_velocity(fluid, depth_at_half_radius * past * past, fluid.yield_stress * std::pow(past, 5));
}

double duct_creep(const RegularisedFluid& fluid, double height, double force) {
  if (!(force > 0.0)) return 0.0;
  return along_the_flow_curve(fluid, fluid.shear_rate(0.5 * force * height),
                              [](double, double g) { return g; }) /
         force;
}

}  // namespace flowrest::compare::exact
