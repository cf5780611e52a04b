#include "foamCases/viscosity.h"

#include <algorithm>
#include <cmath>

namespace flowrest::foam {

namespace {

/// A chord of c / rate over a ratio q of rates lies at most (q - 1)^2 / 4 above it (relative, q near 1).
constexpr double rate_ratio = 1.05;
/// Past this share of the viscosity the yield stress may be held as it is in the last row.
constexpr double negligible = 2e-4;
/// No concrete is sheared faster (1/s); it ends the table of a material that has no plastic viscosity, or one
/// that goes on changing with the rate.
constexpr double largest_rate = 1e6;

}  // namespace

double regularised_viscosity(const scenes::Material& material, double shear_rate) {
  return laws::HerschelBulkley::viscosity(material.flow_curve().parameters, shear_rate) / material.density;
}

std::vector<TablePoint> regularised_table(const scenes::Material& material) {
  const double m = material.regularisation_time.value();
  const double first = 0.01 / m;  // below it the law falls linearly with the rate
  const double flowing =
      material.flow_index == 1.0
          ? material.yield_stress / std::max(negligible * material.plastic_viscosity, 1e-300)
          : largest_rate;
  const double last = std::clamp(flowing, 10.0 * first, std::max(largest_rate, 10.0 * first));
  std::vector<TablePoint> table{{0.0, regularised_viscosity(material, 0.0)}};
  const int rows = static_cast<int>(std::ceil(std::log(last / first) / std::log(rate_ratio)));
  for (int row = 0; row <= rows; ++row) {
    const double rate = first * std::pow(rate_ratio, row);
    table.push_back({rate, regularised_viscosity(material, rate)});
  }
  return table;
}

double viscosity_at_rest(const scenes::Material& material) {
  return material.flow_curve().largest_viscosity() / material.density;
}

}  // namespace flowrest::foam
