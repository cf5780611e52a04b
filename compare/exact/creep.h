#pragma once

#include "laws/law.h"

/// How fast a regularised Bingham fluid goes on creeping where the exact material has stopped.
namespace flowrest::compare::exact {

/// A fluid that imitates a yield stress by a large viscosity at small shear rates.
using RegularisedFluid = laws::FlowCurve;

/// `time` is m of Papanastasiou and Herschel-Bulkley, s; of the bi-viscous law the inverse of its critical
/// shear rate.
inline RegularisedFluid regularised_fluid(laws::Law law, double yield_stress, double plastic_viscosity,
                                          double time, double flow_index = 1.0) {
  return {law, {yield_stress, plastic_viscosity, time, 1.0 / time, flow_index}};
}

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
