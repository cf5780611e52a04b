#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "mpm/boundary/walls.h"
#include "mpm/solver/sparse_blocks.h"

namespace flowrest::mpm {

/// A round upright tube out of which material comes, as in printing. Inside, material comes down as one
/// column; the tube holds what touches it.
struct Nozzle {
  double bore = 0.0;                       ///< m, radius inside
  double wall = 0.0;                       ///< m, thickness
  std::function<Vector(double)> mouth;     ///< m: centre of its end at a time (s)
  std::function<double(double)> extruded;  ///< m of the column that have come out of it until then
  double column = std::numeric_limits<double>::infinity();   ///< m that come out of it in all
  double begins_at = 0.0;                                    ///< s, from when it is there
  double gone_at = std::numeric_limits<double>::infinity();  ///< s, from when it holds nothing any more

  bool is_there(double time) const { return time >= begins_at && time < gone_at; }
};

/// How a nozzle moves in one step, and what it holds.
///
/// On the row of nodes at the mouth, what lies in the bore moves with the column and what lies in the wall
/// with the tube. On the rows above, the column is held as far as the middle of the wall: quadratic functions
/// reach one and a half cells, and particles beside the wall would lag behind the column, gather and be
/// pressed together where no node lets them go. The mouth should lie on a row of nodes, which are in the
/// middle of cells; else it lies on the next row above.
class NozzleMotion {
 public:
  /// From `time` over `step` s; `cell`: m.
  NozzleMotion(const Nozzle&, double time, double step, double cell);

  /// Of what comes down the bore, m/s.
  const Vector& column() const { return column_; }
  /// The velocity of a node at a place (m), where it is held.
  std::optional<Vector> at(const Vector& node) const;
  /// Whether a box (m) of nodes holds none that is.
  bool misses(const Vector& lower, const Vector& upper) const;

 private:
  double bore_, wall_, cell_;
  Vector mouth_, tube_, column_;
};

/// Holds the grid's nodes to nozzles: of quadratic functions, in three dimensions.
template <class T>
class NozzleNodes {
 public:
  /// `cell`: m.
  NozzleNodes(std::vector<Nozzle> nozzles, double cell) : nozzles_(std::move(nozzles)), cell_(cell) {}

  /// Holds the new velocities of a step from `time` over `step` s. `nodes` are records as update_nodes leaves
  /// them. Returns the work on the material, J.
  double hold(const SparseBlocks&, double time, double step, T* nodes);

  /// On the material in the last step, kg m/s.
  const Vector& impulse() const { return impulse_; }

 private:
  double hold(const NozzleMotion&, const SparseBlocks&, T* nodes);

  std::vector<Nozzle> nozzles_;
  double cell_;
  Vector impulse_{};
};

extern template class NozzleNodes<float>;
extern template class NozzleNodes<double>;

}  // namespace flowrest::mpm
