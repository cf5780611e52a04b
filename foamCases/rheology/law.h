#pragma once

#include <algorithm>
#include <cmath>

/// The flow laws of concrete at a point, without OpenFOAM: what the plug-in evaluates in every cell.
///
/// tau = sqrt(s:s / 2) and rate = sqrt(2 D:D) throughout. The material point solver has laws of its own; a
/// test holds the two to each other.
namespace flowrest::rheology {

/// Apparent viscosity of a Papanastasiou fluid, eta + tau0 (1 - exp(-m rate)) / rate, and its limit at rest
/// (Yu et al. 2026, Eq. 10). Pa s
inline double papanastasiou_viscosity(double plastic_viscosity, double yield_stress,
                                      double regularisation_time, double rate) {
  const double x = regularisation_time * rate;
  // expm1 is exact at creep rates; only a rate whose product underflows needs the limit.
  const double yield_part = x > 1e-300 ? -std::expm1(-x) / rate : regularisation_time;
  return plastic_viscosity + yield_stress * yield_part;
}

/// Apparent viscosity of a bi-viscous fluid, tau = eta rate + tau0 min(rate / critical, 1). Pa s
inline double bi_viscous_viscosity(double plastic_viscosity, double yield_stress, double critical_shear_rate,
                                   double rate) {
  return plastic_viscosity + yield_stress / std::max(rate, critical_shear_rate);
}

/// Parameters of the elasto-viscoplastic law; without thixotropy growth and breakdown are 0.
struct ElastoViscoplastic {
  double yield_stress = 0.0;         ///< Pa, tau0
  double plastic_viscosity = 0.0;    ///< Pa s, eta
  double flocculation_growth = 0.0;  ///< 1/s, A_thix / tau0
  double deflocculation = 0.0;       ///< alpha
};

/// What a step leaves of the elastic trial.
struct Relaxed {
  double stress = 0.0;        ///< Pa, tau after the step
  double rate = 0.0;          ///< 1/s, plastic shear rate
  double flocculation = 0.0;  ///< lambda after the step
};

/// The return map of Yu et al. 2026, Eqs. 38 to 47, in closed form. `trial` is tau of the elastic trial, Pa;
/// `shear` is G dt, Pa s. The root of Eq. 43 is taken in a form that does not cancel for small alpha and
/// holds for alpha = 0.
inline Relaxed relax(const ElastoViscoplastic& law, double trial, double shear, double dt,
                     double flocculation) {
  const double viscosity = shear + law.plastic_viscosity;
  const double flocculation_trial = flocculation + law.flocculation_growth * dt;  // Eq. 38
  const double excess = trial - (1.0 + flocculation_trial) * law.yield_stress;    // Eq. 39
  if (!(excess > 0.0)) return {trial, 0.0, flocculation_trial};
  const double xi = viscosity + dt * law.deflocculation * (law.yield_stress - trial);  // Eq. 43
  const double zeta = 2.0 * law.deflocculation * dt * viscosity;
  const double root = std::sqrt(xi * xi + 2.0 * zeta * excess);
  const double rate = xi >= 0.0 ? 2.0 * excess / (xi + root) : (root - xi) / zeta;
  return {trial - shear * rate, rate, flocculation_trial / (1.0 + dt * law.deflocculation * rate)};  // Eq. 45
}

}  // namespace flowrest::rheology
