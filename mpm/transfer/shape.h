#pragma once

#include "mpm/simd/math.h"

/// Shape functions of one axis over one cell. `weight`, `slope` (d weight / d position, per cell) and the
/// node's `offset` from the particle in cells, all as functions of the position in [0, 1) of the cell.
namespace flowrest::mpm {

/// Quadratic B-splines with a node at each cell's centre, so that a cell is a knot span: all its particles
/// see the same three nodes per axis, its own and both neighbours'.
struct Quadratic {
  static constexpr int nodes = 3;
  template <class T>
  static FLOWREST_INLINE T weight(int node, T x) {
    const T below = T(1) - x, centred = x - T(0.5);
    return node == 0 ? T(0.5) * below * below : node == 1 ? T(0.75) - centred * centred : T(0.5) * x * x;
  }
  template <class T>
  static FLOWREST_INLINE T slope(int node, T x) {
    return node == 0 ? x - T(1) : node == 1 ? T(1) - T(2) * x : x;
  }
  template <class T>
  static FLOWREST_INLINE T offset(int node, T x) {
    return T(node) - T(0.5) - x;
  }
  /// Cell widths squared over the second moment of the weights: APIC's D^-1 (Jiang et al. 2015, section 5.3).
  static constexpr double inverse_moment = 4.0;
  /// How far from a cell's faces a particle that enters it is kept, in cells: slopes vanish with the weights.
  static constexpr double margin = 0.0;
};

/// Linear functions with nodes at the cell's corners.
struct Linear {
  static constexpr int nodes = 2;
  template <class T>
  static FLOWREST_INLINE T weight(int node, T x) {
    return node == 0 ? T(1) - x : x;
  }
  template <class T>
  static FLOWREST_INLINE T slope(int node, T) {
    return node == 0 ? T(-1) : T(1);
  }
  /// As above. Slopes stay one where a weight vanishes, so a particle right on a face would see the velocity
  /// gradient to a node that nothing has given a mass.
  static constexpr double margin = 0x1p-20;
};

/// The first or the last of a cell's nodes along an axis. With quadratic functions the middle one takes what
/// these two leave: more than half, so that nothing cancels.
template <class Shape>
FLOWREST_INLINE constexpr int outer_node(int side) {
  return side * (Shape::nodes - 1);
}

}  // namespace flowrest::mpm
