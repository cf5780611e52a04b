#pragma once

#include <utility>

#include "scenes/apparatus/apparatus_header.h"
#include "scenes/apparatus/gcode.h"

namespace flowrest::scenes {

/// A nozzle that lays strands on a bed, one on the other, as Zhang et al. 2026 and Comminal et al. 2020 have
/// it: round, upright, at a height of its own over the bed or the layer below.
struct Printing {
  /// A speed that holds from a time (s) on: m/s.
  using Speeds = std::vector<std::pair<double, double>>;

  double nozzle_diameter = 0.025;  ///< m, of the bore
  double nozzle_wall = 0.003;      ///< m, thickness of the tube
  double nozzle_gap = 0.0125;      ///< m, from the bed to the mouth
  int layers = 1;
  std::optional<double> layer_height;  ///< m, by which the nozzle rises; the gap
  double layer_length = 0.2;           ///< m
  PrintDirection direction = PrintDirection::same;
  Speeds printing_velocity;   ///< along the strand
  Speeds extrusion_velocity;  ///< of the material in the bore
  Speeds flow;                ///< m3/s that come out, in place of it; empty where that is given
  double pause = 0.0;         ///< s, between layers
  /// Where the mouth's middle is, in place of layers; empty where there are layers.
  std::vector<Waypoint> path;

  /// One strand: when it is laid, from where to where, and how much material comes out for it.
  struct Layer {
    double begins_at = 0.0, ends_at = 0.0;  ///< s
    double from = 0.0;                      ///< m along the bed, of the nozzle's axis
    double way = 1.0;                       ///< 1: forwards, -1: backwards
    double mouth = 0.0;                     ///< m over the bed
    double extruded = 0.0;                  ///< m of the column in the bore
  };
  /// Those that begin before `end` s; on cells of `cell` m the mouth lies on the row of nodes next to its
  /// height, half a cell from the faces of cells.
  std::vector<Layer> strands(double end, double cell) const;
  /// m that the nozzle has moved, and of the column that have come out of it, from one time (s) to another.
  double moved(double from, double to) const;
  double extruded(double from, double to) const;
  double lowest_mouth() const;   ///< m over the bed
  double highest_mouth() const;  ///< m over the bed

  static constexpr const char* name = "printing";
  static constexpr const char* dimensions_meaning = "half or full of a printed strand";
  static constexpr bool under_gravity = true;
  static constexpr bool rests = false;
  static constexpr MainGauge main_gauge = MainGauge::section;
  static constexpr double standard_height = 0.0;  ///< m, of the body in the standard; 0: there is none
  static constexpr Dimension usual_dimension = Dimension::half;
  static std::vector<Dimension> dimensions() { return {Dimension::half, Dimension::full}; }
  static std::vector<Key> keys();
  /// m, of all layers when they lie
  double body_size() const { return lowest_mouth(); }
  double body_height() const { return highest_mouth(); }
  void check(const Case&) const;
  void check_gauges(const Case&) const {}
  /// The nozzle drives it, whatever it yields at.
  std::optional<Load> load(const Scene&) const { return std::nullopt; }
  Pieces pieces(const Scene&) const;
  bool operator==(const Printing&) const = default;

 private:
  void check_speeds(const Case&) const;
  void check_path(const Case&) const;
  Pieces pieces_of_layers(const Scene&, double cell) const;
  Pieces pieces_of_path(const Scene&, double cell) const;
  /// Whether it goes along x, at one height and without turning: then it has a section behind it.
  bool path_is_straight() const;
};

}  // namespace flowrest::scenes
