#pragma once

#include "compare/exact/solutions.h"

namespace flowrest::compare::exact {

/// A straight channel, closed at both ends, with concrete let go at one of them: an L-box without its bars.
struct Channel {
  double width = 0.0;   ///< m, between the side walls; infinite without them
  double length = 0.0;  ///< m
  /// Coulomb's coefficient, which bounds the walls' shear stress by the pressure on them; infinite where they
  /// hold the concrete wholly.
  double friction = 0.0;
};

/// The slender shape in which a yield stress on the floor and on the side walls brings the concrete to rest:
/// rho g h dh/dx = -(s(h) + 2/W int_0^h s dz), s(z) = min(tau0, mu rho g z) with the hydrostatic pressure.
/// The floor's part is that of the slump (Yu et al. 2026, Eq. 51, in a plane); that of the side walls is as
/// in Nguyen, Roussel and Coussot (2006). Quasi-static: inertia carries a real flow past it, and a flow that
/// is slow comes to it. Heights are those over the floor, places run along the channel from the closed end.
class ArrestedChannel {
 public:
  /// `volume` in m3.
  ArrestedChannel(const Bingham&, double gravity, const Channel&, double volume);

  double start_height() const { return start_height_; }  ///< m, at the closed end
  double end_height() const { return end_height_; }      ///< m, at the far end; 0 where it does not get there
  double front() const { return front_; }                ///< m, where it ends; the channel's length at most
  double depth(double x) const;                          ///< m
  /// Where the depth falls through `threshold` (m), m.
  double reach(double threshold) const;

 private:
  /// How far the surface runs while it falls by one, where it stands at `height`: -dx/dh.
  double run_of(double height) const;
  /// Length over which the depth falls from one height to another, and the area below, m and m2.
  double length_between(double low, double high) const;
  double area_between(double low, double high) const;
  template <class Function>
  double over_heights(const Function&, double low, double high) const;

  double weight_ = 0.0;  ///< rho g, N/m3
  double yield_stress_ = 0.0;
  Channel channel_;
  double start_height_ = 0.0, end_height_ = 0.0, front_ = 0.0;
};

}  // namespace flowrest::compare::exact
