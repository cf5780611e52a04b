#pragma once

#include "scenes/apparatus/apparatus_header.h"

namespace flowrest::scenes {

/// A column of fluid in the corner of a tank, held by nothing from the start.
struct DamBreak {
  double column_length = 0.6;  ///< m
  double column_height = 0.6;  ///< m
  double width = 0.15;         ///< m, of column and tank; of no consequence in a plane
  double tank_length = 1.61;   ///< m

  static constexpr const char* name = "dam-break";
  static constexpr const char* dimensions_meaning = "plane or full of a dam-break";
  static constexpr bool under_gravity = true;
  static constexpr bool rests = false;
  static constexpr MainGauge main_gauge = MainGauge::front;
  static constexpr double standard_height = 0.6;  ///< m, of the body in the standard; 0: there is none
  static constexpr Dimension usual_dimension = Dimension::plane;
  static std::vector<Dimension> dimensions() { return {Dimension::plane, Dimension::full}; }
  static std::vector<Key> keys();
  double body_height() const { return column_height; }
  double body_size() const { return body_height(); }
  void check(const Case&) const;
  void check_gauges(const Case&) const;
  /// What there is to be held; nothing where walls let it slide, whatever it yields at.
  std::optional<Load> load(const Scene&) const;
  Pieces pieces(const Scene&) const;
  bool operator==(const DamBreak&) const = default;
};

}  // namespace flowrest::scenes
