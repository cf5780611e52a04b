#pragma once

#include <vector>

#include "scenes/scene.h"

/// The regularised Bingham laws as interFoam's built-in viscosity models are given them.
namespace flowrest::foam {

/// One row of a viscosity table.
struct TablePoint {
  double shear_rate = 0.0;           ///< 1/s, sqrt(2 D:D)
  double kinematic_viscosity = 0.0;  ///< m2/s
};

/// Apparent viscosity over density of Herschel and Bulkley's law (laws/herschel_bulkley.h), m2/s. With a flow
/// index of 1 it is Papanastasiou's, (eta + tau0 (1 - exp(-m rate)) / rate) / rho, and eta + tau0 m at rest.
double regularised_viscosity(const scenes::Material&, double shear_rate);

/// The law as a table that linear interpolation between its rows, and its last row beyond them, reproduces to
/// 0.1 %.
std::vector<TablePoint> regularised_table(const scenes::Material&);

/// The kinematic viscosity of a fluid at rest, m2/s. Of the bi-viscous law it is (eta + tau0 /
/// critical_shear_rate) / rho: with it HerschelBulkley's min(nu0, tau0 / rate + k) changes branch at that
/// rate, with a continuous stress.
double viscosity_at_rest(const scenes::Material&);

}  // namespace flowrest::foam
