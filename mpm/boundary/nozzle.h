#pragma once

#include <array>
#include <cmath>
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

/// How a nozzle moves in one step, and how far it holds what is near it.
///
/// On the row of nodes at the mouth, what lies in the bore moves with the column and what lies in the wall
/// with the tube. On the rows above, the column is held as far as the middle of the wall: quadratic functions
/// reach one and a half cells, and particles beside the wall would lag behind the column, gather and be
/// pressed together where no node lets them go. The mouth should lie on a row of nodes, which are in the
/// middle of cells; else it lies on the next row above.
///
/// What holds changes over one cell with a continuous slope: from column to tube about the column's edge, and from
/// tube to nothing about the tube's. A node that was held or not, by a hair, would make the flow jump as the tube
/// moves past it, and nothing printed would have a derivative by the printing velocity.
///
/// `T`: the scalar, which may carry derivatives.
template <class T>
class NozzleMotion {
 public:
  using Place = std::array<T, 3>;
  /// How far a node is held, 0 to 1, and to what, m/s.
  struct Hold {
    T share;
    Place velocity;
  };

  /// A nozzle whose mouth goes from `mouth` to `next` (m) in `step` s, while `came` m of its column come out;
  /// bore, wall and cell in m.
  NozzleMotion(double bore, double wall, double cell, const Place& mouth, const Place& next, const T& came,
               double step)
      : bore_(bore), wall_(wall), cell_(cell), mouth_(mouth) {
    for (std::size_t a = 0; a < 3; ++a) column_[a] = tube_[a] = (next[a] - mouth[a]) / T(step);
    column_[2] -= came / T(step);
  }

  /// The same over another scalar.
  template <class Other>
  explicit NozzleMotion(const NozzleMotion<Other>& other)
      : bore_(other.bore_), wall_(other.wall_), cell_(other.cell_) {
    for (std::size_t a = 0; a < 3; ++a) {
      mouth_[a] = static_cast<T>(other.mouth_[a]);
      tube_[a] = static_cast<T>(other.tube_[a]);
      column_[a] = static_cast<T>(other.column_[a]);
    }
  }

  /// Of what comes down the bore, m/s.
  const Place& column() const { return column_; }

  /// What holds a node at a place (m), if anything does.
  std::optional<Hold> at(const Vector& node) const {
    using std::sqrt;
    if (T(node[2]) - mouth_[2] < T(-round_off * cell_)) return std::nullopt;
    const T x = T(node[0]) - mouth_[0], y = T(node[1]) - mouth_[1], square = x * x + y * y;
    const double outside = bore_ + wall_, reach = outside + 0.5 * cell_;
    if (!(square < T(reach * reach))) return std::nullopt;
    const T radius = square > T(0) ? sqrt(square) : T(0);
    const bool at_mouth = T(node[2]) - mouth_[2] < T(0.5 * cell_);
    const T of_column = within(at_mouth ? bore_ : bore_ + 0.5 * wall_, radius);
    Hold hold{within(outside, radius), tube_};
    for (std::size_t a = 0; a < 3; ++a) hold.velocity[a] += of_column * (column_[a] - tube_[a]);
    return hold;
  }
  /// Whether a box (m) of nodes holds none that is.
  bool misses(const Vector& lower, const Vector& upper) const {
    const T reach(bore_ + wall_ + 0.5 * cell_);
    for (std::size_t a = 0; a < 2; ++a)
      if (T(lower[a]) > mouth_[a] + reach || T(upper[a]) < mouth_[a] - reach) return true;
    return T(upper[2]) < mouth_[2] - T(round_off * cell_);
  }

 private:
  static constexpr double round_off = 1e-9;  ///< cells

  /// 1 inside a radius, 0 outside, and between them a cubic over one cell.
  T within(double edge, const T& radius) const {
    const T inside = (T(edge) - radius) / T(cell_) + T(0.5);
    if (!(inside > T(0))) return T(0);
    return inside < T(1) ? T(inside * inside * (T(3) - T(2) * inside)) : T(1);
  }

  template <class Other>
  friend class NozzleMotion;

  double bore_, wall_, cell_;
  Place mouth_{}, tube_{}, column_{};
};

/// The motion of a nozzle from `time` over `step` s; `cell`: m.
NozzleMotion<double> motion_of(const Nozzle&, double time, double step, double cell);

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
  double hold(const NozzleMotion<double>&, const SparseBlocks&, T* nodes);

  std::vector<Nozzle> nozzles_;
  double cell_;
  Vector impulse_{};
};

extern template class NozzleNodes<float>;
extern template class NozzleNodes<double>;

}  // namespace flowrest::mpm
