#pragma once

#include "scenes/apparatus/apparatus_header.h"

namespace flowrest::scenes {

/// A cone of material released on a plate; the axis of symmetry is vertical.
struct Slump {
  double cone_height = 0.0;         ///< m
  double cone_radius_top = 0.0;     ///< m
  double cone_radius_bottom = 0.0;  ///< m
  double domain_radius = 0.0;       ///< m, bounds the OpenFOAM mesh; material that reaches it ends a run
  double domain_height = 0.0;       ///< m
  /// m/s, at which the mould is lifted; without one the cone is released at once.
  std::optional<double> mould_lift_velocity;
  /// Volume of the cone (a frustum), m3.
  double volume() const;

  static constexpr const char* name = "slump";
  static constexpr const char* dimensions_meaning =
      "axisymmetric, plane (a column of the cone's section), quarter or full of a slump";
  static constexpr bool under_gravity = true;
  static constexpr bool rests = true;
  static constexpr MainGauge main_gauge = MainGauge::spread;
  static constexpr double standard_height = 0.3;  ///< m, of the body in the standard; 0: there is none
  static constexpr Dimension usual_dimension = Dimension::axisymmetric;
  static std::vector<Dimension> dimensions() {
    return {Dimension::axisymmetric, Dimension::plane, Dimension::quarter, Dimension::full};
  }
  static std::vector<Key> keys();
  double body_height() const { return cone_height; }
  double body_size() const;
  void check(const Case&) const;
  void check_gauges(const Case&) const;
  /// What there is to be held; nothing where walls let it slide, whatever it yields at.
  std::optional<Load> load(const Scene&) const;
  Pieces pieces(const Scene&) const;
  bool operator==(const Slump&) const = default;
};

}  // namespace flowrest::scenes
