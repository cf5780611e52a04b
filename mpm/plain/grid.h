#pragma once

#include <algorithm>
#include <vector>

#include "mpm/plain/tensor.h"
#include "mpm/solver/layout.h"

namespace flowrest::mpm::plain {

/// A node lies at the centre of a cell and bears its name.
template <int Dim>
using Cell = std::array<int, Dim>;

template <class T, int Dim>
struct Node {
  T mass{};     ///< kg
  T filling{};  ///< particles' volume per volume of the node: 1 where they neither overlap nor gape
  Vec<T, Dim> momentum{};  ///< kg m/s, before the step's forces
  Vec<T, Dim> impulse{};   ///< kg m/s, of the step's forces
  Vec<T, Dim> velocity{};  ///< m/s, after them
  Vec<T, Dim> before{};    ///< m/s, of the velocity before the step what particles keep
};

/// What particles average through the nodes, which outlasts a step.
template <class T>
struct Average {
  T volume{};      ///< of particles, in kg: their mass times their volume ratio
  T pressure{};    ///< Pa
  T dilatation{};  ///< 1/s
};

/// Which layer of nodes along an axis mirrors which across a plane wall.
struct Mirror {
  int axis;
  PlaneWall wall;
  int ghost, image, second;  ///< behind the wall, its image before it, and the next one

  /// Whether the body is mirrored there as a whole. Behind a wall of friction it is as far as the wall holds,
  /// which is known once the nodes are summed (friction.h).
  bool is_whole() const { return wall != PlaneWall::friction; }
  /// Whether the mirrored body's velocity has the other sign in a component.
  bool is_odd(int component) const { return wall == PlaneWall::no_slip || component == axis; }
};

/// All nodes of a box of cells that grows with the body; periodic axes are as long as their period.
template <class T, int Dim>
class Grid {
 public:
  explicit Grid(const std::array<AxisBounds, 3>& bounds) {
    for (int a = 0; a < Dim; ++a) {
      const AxisBounds& b = bounds[static_cast<std::size_t>(a)];
      axes_[static_cast<std::size_t>(a)].periodic = b.periodic;
      if (b.periodic) {
        axes_[static_cast<std::size_t>(a)].first = b.lower_cell;
        axes_[static_cast<std::size_t>(a)].count = b.upper_cell - b.lower_cell;
      }
      if (b.lower != PlaneWall::none)
        mirrors_.push_back({a, b.lower, b.lower_cell - 1, b.lower_cell, b.lower_cell + 1});
      if (b.upper != PlaneWall::none)
        mirrors_.push_back({a, b.upper, b.upper_cell, b.upper_cell - 1, b.upper_cell - 2});
    }
  }

  const std::vector<Mirror>& mirrors() const { return mirrors_; }
  std::size_t size() const { return nodes_.size(); }
  Node<T, Dim>& node(std::size_t index) { return nodes_[index]; }
  const Node<T, Dim>& node(std::size_t index) const { return nodes_[index]; }
  Average<T>& average(std::size_t index) { return averages_[index]; }
  const Average<T>& average(std::size_t index) const { return averages_[index]; }
  std::vector<Node<T, Dim>>& nodes() { return nodes_; }
  std::vector<Average<T>>& averages() { return averages_; }

  /// Whether a place along an axis is one of the box.
  bool holds(int axis, int cell) const {
    const Axis& a = axes_[static_cast<std::size_t>(axis)];
    return a.periodic || (cell >= a.first && cell < a.first + a.count);
  }
  /// Contribution of an axis to a node's index.
  std::size_t along(int axis, int cell) const {
    const Axis& a = axes_[static_cast<std::size_t>(axis)];
    int place = cell - a.first;
    if (a.periodic) place = (place % a.count + a.count) % a.count;
    return static_cast<std::size_t>(place) * a.stride;
  }
  std::size_t index(const Cell<Dim>& cell) const {
    std::size_t sum = 0;
    for (int a = 0; a < Dim; ++a) sum += along(a, cell[static_cast<std::size_t>(a)]);
    return sum;
  }
  /// The cell of a node.
  Cell<Dim> cell(std::size_t index) const {
    Cell<Dim> cell;
    for (std::size_t a = 0; a < Dim; ++a) {
      cell[a] = axes_[a].first + static_cast<int>(index / axes_[a].stride);
      index %= axes_[a].stride;
    }
    return cell;
  }
  /// A cell's own name: along a periodic axis that within the period.
  Cell<Dim> wrapped(Cell<Dim> cell) const {
    for (std::size_t a = 0; a < Dim; ++a)
      if (axes_[a].periodic)
        cell[a] = axes_[a].first + static_cast<int>(along(static_cast<int>(a), cell[a]) / axes_[a].stride);
    return cell;
  }

  /// Makes the box hold all nodes within `margin` of the cells from `lowest` to `highest`, and keeps the
  /// averages. Returns whether it had to grow, so that indices have changed.
  bool cover(const Cell<Dim>& lowest, const Cell<Dim>& highest) {
    constexpr int margin = 2;  // the nodes a particle sees, one cell further on
    constexpr int spare = 8;
    bool grows = nodes_.empty();
    auto axes = axes_;
    for (std::size_t a = 0; a < Dim; ++a) {
      Axis& axis = axes[a];
      if (axis.periodic) continue;
      const int low = lowest[a] - margin, high = highest[a] + margin + 1;
      const bool fresh = axis.count == 0;
      const int end = axis.first + axis.count;
      if (!fresh && low >= axis.first && high <= end) continue;
      grows = true;
      const int first = fresh || low < axis.first ? low - spare : axis.first;
      axis.count = (fresh || high > end ? high + spare : end) - first;
      axis.first = first;
    }
    if (!grows) return false;
    std::size_t stride = 1;
    for (std::size_t a = Dim; a-- > 0;) {
      axes[a].stride = stride;
      stride *= static_cast<std::size_t>(axes[a].count);
    }
    std::vector<Average<T>> averages(stride);
    for (std::size_t i = 0; i < averages_.size(); ++i) {
      std::size_t to = 0, rest = i;
      for (std::size_t a = 0; a < Dim; ++a) {
        const int place = static_cast<int>(rest / axes_[a].stride) + axes_[a].first - axes[a].first;
        to += static_cast<std::size_t>(place) * axes[a].stride;
        rest %= axes_[a].stride;
      }
      averages[to] = averages_[i];
    }
    axes_ = axes;
    averages_ = std::move(averages);
    nodes_.assign(stride, {});
    return true;
  }

  void clear() { std::fill(nodes_.begin(), nodes_.end(), Node<T, Dim>{}); }

  /// Calls use(from, to) for the nodes of a layer of an axis and those opposite them on another; neither may
  /// lie beyond the box, where nothing is.
  template <class Use>
  void across(int axis, int from, int to, const Use& use) const {
    if (!holds(axis, from) || !holds(axis, to)) return;
    const std::size_t stride = axes_[static_cast<std::size_t>(axis)].stride;
    const std::size_t layer = stride * static_cast<std::size_t>(axes_[static_cast<std::size_t>(axis)].count);
    const std::size_t first = along(axis, from), second = along(axis, to);
    for (std::size_t outer = 0; outer < nodes_.size(); outer += layer)
      for (std::size_t inner = outer; inner < outer + stride; ++inner) use(inner + first, inner + second);
  }

 private:
  struct Axis {
    int first = 0, count = 0;
    std::size_t stride = 1;
    bool periodic = false;
  };
  std::array<Axis, Dim> axes_;
  std::vector<Mirror> mirrors_;
  std::vector<Node<T, Dim>> nodes_;
  std::vector<Average<T>> averages_;
};

/// Quadratic B-splines around a place within a cell, of its own node and its neighbours'. All particles of a
/// cell see the same nodes.
template <class T, int Dim>
struct Stencil {
  std::array<std::array<std::size_t, 3>, Dim> node;         ///< contributions to indices
  std::array<std::array<T, 3>, Dim> weight, slope, offset;  ///< slopes and offsets in cells

  template <class NodesOfAnyScalar>
  Stencil(const NodesOfAnyScalar& grid, const Cell<Dim>& cell, const Vec<T, Dim>& place) {
    for (std::size_t a = 0; a < Dim; ++a) {
      const T& x = place[a];
      const T below = T(1) - x, centred = x - T(0.5);
      weight[a] = {T(0.5) * below * below, T(0.75) - centred * centred, T(0.5) * x * x};
      slope[a] = {-below, T(1) - T(2) * x, x};
      offset[a] = {T(-0.5) - x, T(0.5) - x, T(1.5) - x};
      for (std::size_t i = 0; i < 3; ++i)
        node[a][i] = grid.along(static_cast<int>(a), cell[a] + static_cast<int>(i) - 1);
    }
  }

  /// use(node's index, places of the node along the axes) for every node.
  template <class Use>
  void visit(const Use& use) const {
    if constexpr (Dim == 2) {
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) use(node[0][i] + node[1][j], std::array<std::size_t, 2>{i, j});
    } else {
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          for (std::size_t k = 0; k < 3; ++k)
            use(node[0][i] + node[1][j] + node[2][k], std::array<std::size_t, 3>{i, j, k});
    }
  }
  T weight_of(const std::array<std::size_t, Dim>& n) const {
    T product = weight[0][n[0]];
    for (std::size_t a = 1; a < Dim; ++a) product *= weight[a][n[a]];
    return product;
  }
  /// The weight's gradient, per cell.
  Vec<T, Dim> slope_of(const std::array<std::size_t, Dim>& n) const {
    Vec<T, Dim> gradient;
    for (std::size_t a = 0; a < Dim; ++a) {
      gradient[a] = slope[a][n[a]];
      for (std::size_t b = 0; b < Dim; ++b)
        if (b != a) gradient[a] *= weight[b][n[b]];
    }
    return gradient;
  }
  /// From the place to the node, in cells.
  Vec<T, Dim> offset_of(const std::array<std::size_t, Dim>& n) const {
    Vec<T, Dim> to;
    for (std::size_t a = 0; a < Dim; ++a) to[a] = offset[a][n[a]];
    return to;
  }
};

}  // namespace flowrest::mpm::plain
