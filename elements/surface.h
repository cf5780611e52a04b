#pragma once

#include <vector>

#include "elements/element.h"

namespace flowrest::elements {

/// The free surface: a line of markers from the axis to the toe on the floor, which move with the material.
/// Between them it is straight. Everything that is read off a slump's shape is read off this line.
class Surface {
 public:
  explicit Surface(std::vector<Point> markers);
  /// That of a cone, markers evenly along its top and its side, one on the edge between them.
  static Surface of_cone(const Problem&, int markers);

  const std::vector<Point>& markers() const { return marker_; }
  /// Length along the line from the axis to each marker, m.
  const std::vector<double>& lengths() const { return length_; }
  double length() const { return length_.back(); }
  /// The point at a length along the line.
  Point at(double length) const;
  const Point& toe() const { return marker_.back(); }
  /// The farthest point from the axis, m: beyond the toe where the front overhangs.
  double radius() const;

  /// Of the whole body, m3; in a plane of both halves, a metre wide.
  double volume(Symmetry) const;
  /// Volume per plan area at a radius, m: what lies over a point, without a gap under an overhang.
  double depth(double radius) const;
  /// Twice the largest radius at which the depth falls through `threshold`, exactly that of the line; nothing
  /// (runs::nothing) where it is nowhere as deep. m
  double spread(double threshold) const;

 private:
  std::vector<Point> marker_;
  std::vector<double> length_;
};

/// What has come down to the floor is floor: the line is cut where it first comes within `tolerance` (m) of
/// it, coming from the axis, and ends there, on the floor. A wedge of air between a front and the floor
/// beyond the toe that it had is closed, too, where its height over its length is less than `wedge`.
Surface landed(const std::vector<Point>& markers, double tolerance, double wedge);
/// The same surface with heights multiplied so that its volume is `volume`.
Surface with_volume(const Surface&, Symmetry, double volume);

}  // namespace flowrest::elements
