#pragma once

#include <functional>
#include <vector>

#include "compare/exact/creep.h"
#include "compare/exact/solutions.h"

/// The slump as a thin film: how it approaches its arrested shape in time, without inertia.
namespace flowrest::compare::exact {

/// Flux of a film of Bingham material down a slope, per width (Liu and Mei 1989): with the base stress tau_b
/// = rho g h s above tau0 it yields up to Y = h (1 - tau0/tau_b) and carries rho g s Y^2 (3 h - Y)/(6 eta).
/// m2/s
double film_flux(const Bingham&, double gravity, double depth, double slope);
/// The slope that would shear the base of a film as it is sheared with the pull of the plug above it: at rest
/// and close to it the plug is at yield, stretched alike in all directions, and carries 1.36 tau0 h, so that
/// the base stress is (rho g h - 1.36 tau0) |h'|. Its arrested shape is second_order_slump.
double slope_under_plug(const Bingham&, double gravity, double depth, double slope);
/// film_flux of a regularised fluid: depth times film_velocity, its integral by fewer points. m2/s
double film_flux(const RegularisedFluid&, double density, double gravity, double depth, double slope);

/// Depth and spread of an axisymmetric film as it spreads.
struct FilmState {
  double time = 0.0;          ///< s
  std::vector<double> depth;  ///< m, of equal rings
  double spacing = 0.0;       ///< m
  std::vector<double> centres() const;
  double volume() const;  ///< m3
};

/// h_t + (r q)_r / r = 0 on equal rings, implicit in time with steps that grow with time; q(depth, slope) is
/// any of film_flux. Near rest Bingham's excess of stress over yield falls as 1/t, so the spread has a growth
/// of the order of 1/t still to come and its speed falls only as 1/t^2: a thin film of yield-stress fluid is
/// never at rest in finite time (Matson and Hogg 2007 found the like for dam breaks).
class SpreadingFilm {
 public:
  using Flux = std::function<double(double depth, double slope)>;

  /// A cylinder of `radius` and `volume` (m, m3) let go at time 0 on `rings` rings out to `domain_radius`.
  SpreadingFilm(Flux, double radius, double volume, double domain_radius, int rings);

  /// Goes on to `time`, s.
  /// @throws std::runtime_error where a step finds no solution.
  void advance_to(double time);
  const FilmState& state() const { return state_; }

 private:
  bool try_step(double step, std::vector<double>& depth) const;
  double face_flux(double inner, double outer) const;

  Flux flux_;
  FilmState state_;
  double step_ = 1e-6;
};

/// The film of a slump of Bingham material, let go as a cylinder; with the pull of its plug or without.
SpreadingFilm bingham_film(const Bingham&, double gravity, double radius, double volume, double domain_radius,
                           int rings, bool plug_pulls);

/// Speed at which the spread of a slump still grows at a time well after its fall, without and with the pull
/// of its plug, read at `spread_depth`: what exact Bingham material does as it approaches rest. m/s
struct Approach {
  double film = 0.0, under_plug = 0.0;
};
/// By SpreadingFilm from the cone's foot, over as long as makes the width of its rings matter little: with
/// D = D_rest - c / t the speed c / t^2 is sqrt(2) (D(sqrt(2) t) - D(t / sqrt(2))) / t.
Approach approach_to_rest(const Bingham&, double gravity, double radius, double volume, double domain_radius,
                          double time, double spread_depth);

}  // namespace flowrest::compare::exact
