#pragma once

#include "scenes/apparatus/apparatus_header.h"

namespace flowrest::scenes {

/// EN 12350-9: a funnel between two upright plates, over an outlet that opens at once (Yu et al. 2026, Fig.
/// 24). x runs across its slopes, heights from the outlet.
struct VFunnel {
  double top_width = 0.515;     ///< m
  double outlet_width = 0.065;  ///< m
  double depth = 0.075;         ///< m, between the plates
  double taper_height = 0.45;   ///< m
  double neck_height = 0.15;    ///< m
  double fall_height = 0.25;    ///< m, from the outlet to the floor that catches the material
  double height() const { return taper_height + neck_height; }
  double width_at(double height) const;  ///< m, between the slopes
  double volume() const;                 ///< m3

  static constexpr const char* name = "v-funnel";
  static constexpr const char* dimensions_meaning = "plane, quarter or full of a v-funnel";
  static constexpr bool under_gravity = true;
  static constexpr bool rests = false;
  static constexpr MainGauge main_gauge = MainGauge::discharge;
  static constexpr double standard_height = 0.6;  ///< m, of the body in the standard; 0: there is none
  static constexpr Dimension usual_dimension = Dimension::quarter;
  static std::vector<Dimension> dimensions() {
    return {Dimension::plane, Dimension::quarter, Dimension::full};
  }
  static std::vector<Key> keys();
  double body_height() const { return height(); }
  double body_size() const { return body_height(); }
  void check(const Case&) const;
  void check_gauges(const Case&) const;
  /// What there is to be held; nothing where walls let it slide, whatever it yields at.
  std::optional<Load> load(const Scene&) const;
  Pieces pieces(const Scene&) const;
  bool operator==(const VFunnel&) const = default;
};

}  // namespace flowrest::scenes
