#pragma once

#include <vector>

/// Exact and asymptotic solutions as plain functions of SI quantities.
namespace flowrest::compare::exact {

/// What a Bingham material is to these solutions, or with a flow index n that of Herschel and Bulkley, tau =
/// tau0 + K rate^n.
struct Bingham {
  double density = 0.0;            ///< kg/m3
  double yield_stress = 0.0;       ///< Pa
  double plastic_viscosity = 0.0;  ///< Pa s; K in Pa s^n
  double flow_index = 1.0;         ///< n, of which an arrested shape knows nothing
};

/// The arrested, slender slump whose base carries the yield stress everywhere: h = a + sqrt(a^2 + 2 tau0 (R -
/// r)/(rho g)). a = 0 is the leading order in H/R. Quasi-static: inertia, which carries a real slump past it,
/// has no part in it.
struct ArrestedSlump {
  double length = 0.0;  ///< tau0/(rho g), m
  double nose = 0.0;    ///< a, m: half the depth of the blunt nose
  double radius = 0.0;  ///< R, m

  double depth(double r) const;  ///< m; 0 beyond the nose
  double volume() const;         ///< m3, closed form
  /// Twice the radius at which the depth falls through `threshold` (m).
  double spread(double threshold) const;
};

/// Leading order: R = (225 rho g V^2 / (128 pi^2 tau0))^(1/5), Yu et al. 2026, Eq. 51; the profile printed
/// there beside it is linear in R - r, which has the wrong units: the one that carries tau0 at the base is
/// its square root.
ArrestedSlump leading_order_slump(const Bingham&, double gravity, double volume);

/// Pull of a pseudo-plug that yields stretched alike in all directions, over tau0 h: 3 / sqrt(3) pi / 4, as
/// s_rr - s_zz = sqrt(3 (tau0^2 - tau_rz^2)) with tau_rz falling linearly from tau0 at the base.
inline constexpr double plug_pull = 1.36;

/// With the extensional stress of the pseudo-plug above the sheared base, which adds to the hydrostatic
/// thrust and shortens the slump: a = 1.36 tau0/(rho g), R from the volume.
ArrestedSlump second_order_slump(const Bingham&, double gravity, double volume);

/// The arrested slump in plane flow, one half: h = sqrt(2 tau0 (X - x)/(rho g)), X = (9 rho g A^2/(8
/// tau0))^(1/3).
struct ArrestedPlaneSlump {
  double length = 0.0;      ///< tau0/(rho g), m
  double half_width = 0.0;  ///< X, m
  double depth(double x) const;
  double half_area() const;  ///< m2
  double spread(double threshold) const;
};
ArrestedPlaneSlump plane_slump(const Bingham&, double gravity, double half_area);

/// Steady flow between plates `height` apart under a body force (N/m3); y from the mid-plane. Yu et al. 2026,
/// Eqs. 48-50, and with a flow index u = n / (n + 1) (F / K)^(1/n) ((H/2 - y0)^(1 + 1/n) - (y - y0)^(1 + 1/n)).
struct DuctFlow {
  Bingham material;
  double height = 0.0;
  double force = 0.0;

  double plug_half_width() const;   ///< y0 = tau0/F, at most half the height, m
  double velocity(double y) const;  ///< m/s
  double plug_velocity() const;     ///< m/s; 0 where the force is below 2 tau0/height
  double mean_velocity() const;     ///< m/s
  double l2_norm() const;           ///< sqrt of the integral of velocity^2 over the height, m^1.5/s
};

/// Upper bound on the time a duct flow of L2 norm `l2_norm` needs to stop under a force below yield:
/// integrating d|u|/dt <= -a |u| - b, a = pi^2 eta/(rho H^2), b = 2 (tau0 - F H/2)/(rho sqrt(H)), which the
/// energy balance gives with Poincare's inequality and max|u| <= (1/2) int|u'|; with a flow index other than 1
/// the yield stress alone is counted, a = 0. Infinite where the force does
/// not stop it. s
double stopping_time_bound(const Bingham&, double height, double force, double l2_norm);

}  // namespace flowrest::compare::exact
