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

double film_velocity(const RegularisedFluid& fluid, double depth, double base_stress) {
  if (!(base_stress > 0.0)) return 0.0;
  return depth / (base_stress * base_stress) *
         along_the_flow_curve(fluid, fluid.rate(base_stress), [](double tau, double g) { return tau * g; });
}

double spread_creep(const RegularisedFluid& fluid, double arrested_radius, double depth_at_half_radius,
                    double radius) {
  const double past = std::min(1.0, arrested_radius / radius);
  return 4.0 * film_velocity(fluid, depth_at_half_radius * past * past,
                             fluid.parameters.yield_stress * std::pow(past, 5));
}

double duct_creep(const RegularisedFluid& fluid, double height, double force) {
  if (!(force > 0.0)) return 0.0;
  return along_the_flow_curve(fluid, fluid.rate(0.5 * force * height), [](double, double g) { return g; }) /
         force;
}

}  // namespace flowrest::compare::exact
