#pragma once

#include "scenes/apparatus/apparatus_header.h"

namespace flowrest::scenes {

/// A layer between two parallel plates, periodic along x and driven along x.
struct Duct {
  double height = 0.0;  ///< m, between the plates

  static constexpr const char* name = "duct";
  static constexpr const char* dimensions_meaning = "plane of a duct";
  static constexpr bool under_gravity = false;
  static constexpr bool rests = false;
  static constexpr MainGauge main_gauge = MainGauge::velocity;
  static constexpr double standard_height = 0.0;  ///< m, of the body in the standard; 0: there is none
  static constexpr Dimension usual_dimension = Dimension::plane;
  static std::vector<Dimension> dimensions() { return {Dimension::plane}; }
  static std::vector<Key> keys();
  double body_height() const { return height; }
  double body_size() const { return body_height(); }
  void check(const Case&) const;
  void check_gauges(const Case&) const {}
  /// What there is to be held; nothing where walls let it slide, whatever it yields at.
  std::optional<Load> load(const Scene&) const;
  Pieces pieces(const Scene&) const;
  bool operator==(const Duct&) const = default;
};

}  // namespace flowrest::scenes
