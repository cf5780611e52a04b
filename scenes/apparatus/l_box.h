#pragma once

#include "scenes/apparatus/apparatus_header.h"

namespace flowrest::scenes {

/// EN 12350-10: a reservoir whose gate opens on a channel behind upright bars (Yu et al. 2026, Fig. 18). x
/// runs along the channel from the reservoir's back wall.
struct LBox {
  double reservoir_length = 0.1;  ///< m, along the channel
  double reservoir_height = 0.6;  ///< m, filled to the brim
  double width = 0.2;             ///< m, across
  double channel_length = 0.6;    ///< m, from the reservoir to the end wall
  double channel_height = 0.15;   ///< m, of the opening under the reservoir's front wall
  int rebars = 3;                 ///< upright, evenly across the width
  double rebar_diameter = 0.012;  ///< m
  double rebar_distance = 0.006;  ///< m, of the bars' axes from the reservoir
  /// m/s, at which the gate is lifted; without one it is gone at once.
  std::optional<double> gate_lift_velocity;
  double length() const { return reservoir_length + channel_length; }

  static constexpr const char* name = "l-box";
  static constexpr const char* dimensions_meaning = "plane, half or full of an l-box";
  static constexpr bool under_gravity = true;
  static constexpr bool rests = true;
  static constexpr MainGauge main_gauge = MainGauge::front;
  static constexpr double standard_height = 0.6;  ///< m, of the body in the standard; 0: there is none
  static constexpr Dimension usual_dimension = Dimension::half;
  static std::vector<Dimension> dimensions() { return {Dimension::plane, Dimension::half, Dimension::full}; }
  static std::vector<Key> keys();
  double body_height() const { return reservoir_height; }
  double body_size() const { return body_height(); }
  void check(const Case&) const;
  void check_gauges(const Case&) const;
  /// What there is to be held; nothing where walls let it slide, whatever it yields at.
  std::optional<Load> load(const Scene&) const;
  Pieces pieces(const Scene&) const;
  bool operator==(const LBox&) const = default;
};

}  // namespace flowrest::scenes
