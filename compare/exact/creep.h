#pragma once

/// How fast a regularised Bingham fluid goes on creeping where the exact material has stopped.
namespace flowrest::compare::exact {

/// A fluid that imitates a yield stress by a large viscosity at small shear rates.
struct RegularisedFluid {
  enum class Law { papanastasiou, bi_viscous };
  Law law = Law::papanastasiou;
  double yield_stress = 0.0;         ///< Pa
  double plastic_viscosity = 0.0;    ///< Pa s
  double regularisation_time = 0.0;  ///< m, s; of the bi-viscous law the inverse of its critical shear rate

  double largest_viscosity() const { return plastic_viscosity + regularisation_time * yield_stress; }
  /// tau = eta g + tau0 (1 - exp(-m g)), or min(eta0 g, tau0 + eta g) with eta0 = eta + m tau0; g = sqrt(2
  /// D:D).
  double stress(double shear_rate) const;
  /// The inverse of stress().
  double shear_rate(double stress) const;
};

/// Depth-mean velocity of a film of `depth` whose base carries `base_stress`: (depth/base_stress^2) int tau g
/// dtau. On a bi-viscous fluid at the yield stress it is tau0 depth/(3 eta0). m/s
double film_velocity(const RegularisedFluid&, double depth, double base_stress);

/// Rate at which the spread (twice the radius) of a slump of radius R goes on growing. The base of the
/// profile arrested at R0 carries the yield stress everywhere, hence the depth-mean velocity u at half the
/// radius by film_velocity. If the shape stays similar while it creeps, h = H f(r/R) with H R^2 constant,
/// continuity gives u = r (dR/dt)/R, so d(2R)/dt = 4 u(R/2). Past R0 the depth falls as (R0/R)^2 and the base
/// stress, rho g h dh/dr, as (R0/R)^5; short of it the yield stress is kept: what still flows there is no
/// creep. m/s
double spread_creep(const RegularisedFluid&, double arrested_radius, double depth_at_half_radius,
                    double radius);

/// Velocity of the middle of a duct under a steady force (N/m3): (1/F) int_0^{F H/2} g dtau. m/s
double duct_creep(const RegularisedFluid&, double height, double force);

}  // namespace flowrest::compare::exact
