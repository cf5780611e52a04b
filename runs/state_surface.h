#pragma once

#include <array>
#include <functional>
#include <vector>

#include "runs/material_state.h"

/// What a receiver asks of a state: how much stands on a piece of the plan, and what the material there
/// carries.
namespace flowrest::runs {

/// The free surface of a state, drawn inside its columns: each keeps its volume, and within it the depth
/// follows its neighbours; the ring or strip that holds the front ends where the gauge reads the front, as
/// arrested material does, h = C sqrt(R - r).
class StateSurface {
 public:
  /// `thinnest`: the depth at which the front is looked for, m.
  StateSurface(const DepthColumns&, double thinnest);

  /// Volume at rest of the whole body over a piece of the plan, m3. What adjoining pieces hold adds up.
  double volume(double west, double east, double south, double north) const;
  double reach() const { return reach_; }  ///< m along x, and of squares along y: nothing stands beyond

 private:
  void draw_profile(const DepthColumns&, double thinnest);
  void draw_squares(const DepthColumns&);
  double area(std::size_t i, std::size_t j) const;

  DepthColumns::Plan plan_;
  double width_;                   ///< m, of a slip
  std::size_t along_x_, along_y_;  ///< slips
  std::vector<double> depth_;      ///< m, of each slip, into which columns are cut
  double reach_ = 0.0;
};

/// What the material at a place carries: the mean over the parcels there.
struct Carried {
  std::array<double, 3> velocity{};
  std::array<double, 6> stress{};
  double shear_rate = 0.0, volume_ratio = 1.0, flocculation = 0.0;
};

/// Finds the parcels about a place.
class ParcelField {
 public:
  explicit ParcelField(const MaterialState&);
  /// The mean over the parcels that a box overlaps, by the volume they have in it; where there are none, over
  /// those of the nearest place that has some.
  Carried in_box(const std::array<double, 3>& low, const std::array<double, 3>& high) const;

 private:
  bool add_up(const std::array<double, 3>& low, const std::array<double, 3>& high, Carried&) const;
  std::array<std::size_t, 3> bin(const std::array<double, 3>& place) const;

  const std::vector<Parcel>& parcels_;
  std::array<double, 3> low_{}, high_{}, width_{};
  std::array<std::size_t, 3> bins_{1, 1, 1};
  std::vector<std::vector<std::uint32_t>> of_bin_;
};

/// What a receiver has made of a state: places with a mass each, kg, of the whole body.
struct Received {
  std::vector<double> mass;
  std::vector<Carried> carried;
};

/// Gives the received the state's momentum, each component, and its flocculation, which means over other
/// boxes miss by a little: velocities change in proportion to themselves, so that what stands still stays.
void conserve(const MaterialState&, Received&);

}  // namespace flowrest::runs
