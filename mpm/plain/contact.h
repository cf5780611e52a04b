#pragma once

#include "mpm/boundary/walls.h"
#include "mpm/plain/grid.h"

/// Walls of any shape: what they do to the grid's velocities, and how they keep particles out.
namespace flowrest::mpm::plain {

template <class T, int Dim>
T dot(const Vec<T, Dim>& a, const Vec<T, Dim>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < Dim; ++i) sum += a[i] * b[i];
  return sum;
}

/// A wall acts at points of its surface, at most a cell apart. At each it holds the velocity that the shape
/// functions give there, v = sum N_i v_i, and its impulse goes to the nodes with the same N_i, so that the
/// whole reaction of the wall is known point by point and limits the friction there. The impulses of all
/// points are found together, by projected Gauss-Seidel sweeps from the last step's forces.
template <class T, int Dim>
class Contact {
 public:
  /// `friction`: a coefficient for each wall.
  Contact(const std::vector<Wall>& walls, std::vector<T> friction, double cell,
          const std::array<AxisBounds, 3>& bounds)
      : walls_(walls), friction_(std::move(friction)), cell_(cell), bounds_(bounds) {
    for (std::size_t w = 0; w < walls_.size(); ++w)
      for (const SurfacePoint& at : walls_[w].shape->surface(cell_))
        if (!is_mirrored(at.place)) points_.push_back(Point{w, at, {}, 0.0, {}, {}, {}, {}});
  }

  /// Holds the nodes' velocities to the walls as they stand at `time`; `driven` is the speed that the driving
  /// force gives in the step (m/s), from which the sweeps' tolerance follows. Returns the walls' work, J.
  T hold(Grid<T, Dim>& grid, double time, const T& step, const T& driven) {
    find_nodes(grid, time);
    weigh(grid);
    for (Point* p : touched_)
      for (std::size_t c = 0; c < Dim; ++c) p->impulse[c] = p->force[c] * step;
    for (const Point* p : touched_) push(grid, *p, p->impulse);
    sweep_to_rest(grid, time, driven);
    T work(0);
    for (Point& p : points_) p.force = {};
    for (Point* p : touched_) {
      for (std::size_t c = 0; c < Dim; ++c) p->force[c] = p->impulse[c] / step;
      work += dot<T, Dim>(p->impulse, velocity_at(grid, *p));
    }
    return work;
  }

  /// Force of a wall on the material in the last step, N.
  Vec<T, Dim> force(std::size_t wall) const {
    Vec<T, Dim> sum{};
    for (const Point& p : points_)
      if (p.wall == wall)
        for (std::size_t c = 0; c < Dim; ++c) sum[c] += p.force[c];
    return sum;
  }
  /// Calls use(force) for the force at every point, which the next step starts from.
  template <class Use>
  void visit_forces(const Use& use) {
    for (Point& p : points_) use(p.force);
  }

  /// Moves a place (m) that lies inside walls as they stand at `time` to their surface, by at most half a
  /// cell along each axis; returns whether it did. Derivatives follow the surface's tangent plane.
  bool push_out(Vec<T, Dim>& place, double time) const {
    const double most = 0.5 * cell_, small = 1e-6 * most;
    bool moved = false;
    for (const Wall& wall : walls_) {
      if (!wall.stands(time)) continue;
      const Vector here = values(place);
      const double distance = wall.distance(here, time);
      if (!(distance < 0.0)) continue;
      Vec<double, Dim> gradient{};
      double square = 0.0;
      T depth = T(-distance);
      for (std::size_t a = 0; a < Dim; ++a) {
        Vector ahead = here, behind = here;
        ahead[a] += small;
        behind[a] -= small;
        gradient[a] = (wall.distance(ahead, time) - wall.distance(behind, time)) / (2.0 * small);
        square += gradient[a] * gradient[a];
        depth -= T(gradient[a]) * (place[a] - T(here[a]));
      }
      if (!(square > 0.0)) continue;
      for (std::size_t a = 0; a < Dim; ++a) {
        const T out = T(gradient[a] / std::sqrt(square)) * depth;
        place[a] += out < T(-most) ? T(-most) : T(most) < out ? T(most) : out;
      }
      moved = true;
    }
    return moved;
  }

  /// Whether a particle of a cell may get into a wall within a step in which it goes no further than `reach`
  /// cells. A distance changes by no more than one goes, so a cell is safe from a wall that is farther from
  /// its centre than that. Cells are looked at once, and again when a wall has moved a quarter of a cell.
  bool is_near(const Grid<T, Dim>& grid, const Cell<Dim>& cell, double time) {
    constexpr double leeway = 0.25;
    if (seen_.size() != grid.size() || has_moved(leeway * cell_, time)) {
      seen_.assign(grid.size(), Seen::no);
      looked_at_ = time;
    }
    Seen& seen = seen_[grid.index(cell)];
    if (seen == Seen::no) {
      Vector centre{};
      for (std::size_t a = 0; a < Dim; ++a) centre[a] = (cell[a] + 0.5) * cell_;
      const double most = (0.5 * std::sqrt(double{Dim}) + reach + leeway) * cell_;
      seen = Seen::far;
      for (const Wall& wall : walls_)
        if (wall.distance(centre, looked_at_) < most) seen = Seen::near;
    }
    return seen == Seen::near;
  }
  static constexpr double reach = 0.25;  ///< cells

  /// Indices have changed: nodes are looked for anew.
  void forget_nodes() {
    placed_at_ = -1.0;
    seen_.clear();
  }

 private:
  /// Sweeps at most, how many of them ask every point, and the share of the driving speed at which they end.
  static constexpr int most_sweeps = 12, full_sweeps = 4;
  static constexpr double tolerance = 5e-3;
  /// Weights of nodes that are light beside this share of the heaviest around a point fade with their mass:
  /// at the edge of a body a light node would take up the whole constraint and hold nothing.
  static constexpr double light_share = 0.01;
  static constexpr double smallest_share = 1e-12;  ///< of the heaviest node: one with less is not moved

  /// What a point takes from a node, per velocity component: a mirrored node's sign may differ.
  struct Entry {
    std::size_t node;
    Vec<double, Dim> weight;
    Vec<T, Dim> effective, response;  ///< in this step; change of the node's velocity per impulse, 1/kg
  };
  struct Point {
    std::size_t wall = 0;
    SurfacePoint at;
    std::vector<Entry> entries;
    double missing = 0.0;   ///< weights of nodes beyond the box
    Vec<T, Dim> force{};    ///< N, of the last step
    Vec<T, Dim> impulse{};  ///< kg m/s
    T mobility{};           ///< velocity per impulse, 1/kg; zero where nothing touches the point
    T changed{};            ///< velocity, squared, when it was relaxed last, m2/s2
  };
  enum class Seen : char { no, far, near };

  static Vector values(const Vec<T, Dim>& x) {
    Vector v{};
    for (std::size_t a = 0; a < Dim; ++a) v[a] = value(x[a]);
    return v;
  }

  /// Whether a place lies behind a plane along the grid, where only an image of it is computed.
  bool is_mirrored(const Vector& place) const {
    constexpr double round_off = 1e-9;
    for (std::size_t a = 0; a < Dim; ++a) {
      const double cells = place[a] / cell_;
      if (bounds_[a].lower != PlaneWall::none && cells < bounds_[a].lower_cell - round_off) return true;
      if (bounds_[a].upper != PlaneWall::none && cells > bounds_[a].upper_cell + round_off) return true;
    }
    return false;
  }

  bool has_moved(double length, double time) const {
    for (const Wall& wall : walls_) {
      if (!wall.motion.moves()) continue;
      const Vector before = wall.motion.displacement(looked_at_), now = wall.motion.displacement(time);
      double square = 0.0;
      for (std::size_t a = 0; a < 3; ++a) square += (now[a] - before[a]) * (now[a] - before[a]);
      if (square > length * length) return true;
    }
    return false;
  }

  /// Which nodes lie around every point.
  void find_nodes(const Grid<T, Dim>& grid, double time) {
    for (Point& p : points_) {
      const Wall& wall = walls_[p.wall];
      if (placed_at_ >= 0.0 && wall.stands(time) == wall.stands(placed_at_) &&
          wall.motion.displacement(time) == wall.motion.displacement(placed_at_))
        continue;
      p.entries.clear();
      p.missing = 0.0;
      if (wall.stands(time)) find_nodes(grid, p, wall.motion.displacement(time));
    }
    placed_at_ = time;
  }

  void find_nodes(const Grid<T, Dim>& grid, Point& p, const Vector& displacement) const {
    Cell<Dim> cell;
    Vec<double, Dim> place;
    for (std::size_t a = 0; a < Dim; ++a) {
      // The cell before the wall where the point lies on a face: there the material is.
      constexpr double inwards = 1e-9;
      const double x = (p.at.place[a] + displacement[a]) / cell_;
      cell[a] = static_cast<int>(std::floor(x + inwards * p.at.normal[a]));
      place[a] = x - cell[a];
    }
    std::array<std::array<double, 3>, Dim> weight;
    for (std::size_t a = 0; a < Dim; ++a) {
      const double x = place[a];
      weight[a] = {0.5 * (1.0 - x) * (1.0 - x), 0.75 - (x - 0.5) * (x - 0.5), 0.5 * x * x};
    }
    std::array<int, 3> n{};
    for (n[0] = 0; n[0] < 3; ++n[0])
      for (n[1] = 0; n[1] < 3; ++n[1])
        for (n[2] = 0; n[2] < (Dim == 3 ? 3 : 1); ++n[2]) {
          constexpr double nothing = 1e-12;  // a plane along the grid sees two rows of nodes, not three
          double product = 1.0;
          Cell<Dim> node = cell;
          for (std::size_t a = 0; a < Dim; ++a) {
            product *= weight[a][static_cast<std::size_t>(n[a])];
            node[a] += n[a] - 1;
          }
          if (product >= nothing) add_node(grid, p, node, product);
        }
  }

  /// A node behind a plane along the grid stands for its image, with the sign of the mirrored body. Those behind
  /// one of friction are the body's own.
  void add_node(const Grid<T, Dim>& grid, Point& p, Cell<Dim> cell, double weight) const {
    Vec<double, Dim> signed_weight;
    signed_weight.fill(weight);
    for (const Mirror& mirror : grid.mirrors()) {
      if (!mirror.is_whole()) continue;
      const auto a = static_cast<std::size_t>(mirror.axis);
      const bool behind = mirror.ghost < mirror.image ? cell[a] <= mirror.ghost : cell[a] >= mirror.ghost;
      if (!behind) continue;
      for (std::size_t c = 0; c < Dim; ++c)
        if (mirror.is_odd(static_cast<int>(c))) signed_weight[c] = -signed_weight[c];
      cell[a] = mirror.ghost + mirror.image - cell[a];
    }
    for (std::size_t a = 0; a < Dim; ++a)
      if (!grid.holds(static_cast<int>(a), cell[a])) {
        p.missing += weight;
        return;
      }
    const std::size_t node = grid.index(cell);
    for (Entry& e : p.entries)
      if (e.node == node) {
        for (std::size_t c = 0; c < Dim; ++c) e.weight[c] += signed_weight[c];
        return;
      }
    p.entries.push_back({node, signed_weight, {}, {}});
  }

  /// The weights of the step, which fade where nodes are light, and what a push at a point does. Shape
  /// functions sum to one; so do what is left of them, but for mirrored nodes, whose sum stays.
  void weigh(Grid<T, Dim>& grid) {
    touched_.clear();
    for (Point& p : points_) {
      T heaviest(0);
      for (const Entry& e : p.entries)
        if (heaviest < grid.node(e.node).mass) heaviest = grid.node(e.node).mass;
      p.mobility = T(0);
      if (!(heaviest > T(0))) continue;
      T before = T(p.missing), after(0);
      for (Entry& e : p.entries) {
        const T& mass = grid.node(e.node).mass;
        const T fading = mass / (mass + T(light_share) * heaviest);
        double largest = 0.0;
        for (std::size_t c = 0; c < Dim; ++c) {
          largest = std::max(largest, std::abs(e.weight[c]));
          e.effective[c] = T(e.weight[c]) * fading;
        }
        before += T(largest);
        after += T(largest) * fading;
      }
      const T scale = before / after;
      Vec<T, Dim> mobility{};
      for (Entry& e : p.entries) {
        const T& mass = grid.node(e.node).mass;
        const T per_mass = mass > T(smallest_share) * heaviest ? T(1) / mass : T(0);
        for (std::size_t c = 0; c < Dim; ++c) {
          e.effective[c] *= scale;
          e.response[c] = e.effective[c] * per_mass;
          mobility[c] += e.effective[c] * e.response[c];
        }
      }
      // The largest for all directions: they differ only beside mirrored nodes.
      for (const T& m : mobility)
        if (p.mobility < m) p.mobility = m;
      if (p.mobility > T(0)) touched_.push_back(&p);
    }
  }

  Vec<T, Dim> velocity_at(Grid<T, Dim>& grid, const Point& p) const {
    Vec<T, Dim> v{};
    for (const Entry& e : p.entries)
      for (std::size_t c = 0; c < Dim; ++c) v[c] += e.effective[c] * grid.node(e.node).velocity[c];
    return v;
  }
  void push(Grid<T, Dim>& grid, const Point& p, const Vec<T, Dim>& impulse) const {
    for (const Entry& e : p.entries)
      for (std::size_t c = 0; c < Dim; ++c) grid.node(e.node).velocity[c] += e.response[c] * impulse[c];
  }

  /// The impulse that a wall allows of the one after which the point would move with it.
  Vec<T, Dim> lawful(const Point& p, Vec<T, Dim> wanted) const {
    using std::sqrt;
    if (walls_[p.wall].contact == mpm::Contact::stick) return wanted;
    Vec<T, Dim> normal;
    for (std::size_t c = 0; c < Dim; ++c) normal[c] = T(p.at.normal[c]);
    const T off = dot<T, Dim>(wanted, normal), pressed = off > T(0) ? off : T(0);
    Vec<T, Dim> along;
    for (std::size_t c = 0; c < Dim; ++c) along[c] = wanted[c] - off * normal[c];
    const T square = dot<T, Dim>(along, along), limit = friction_[p.wall] * pressed;
    const T share = square > limit * limit ? limit / sqrt(square) : T(1);
    for (std::size_t c = 0; c < Dim; ++c) wanted[c] = pressed * normal[c] + share * along[c];
    return wanted;
  }

  /// Moves a point's impulse to what its velocity asks for and its wall allows.
  void relax(Grid<T, Dim>& grid, Point& p, double time) const {
    const Vector moving = walls_[p.wall].motion.velocity_at(time);
    const Vec<T, Dim> v = velocity_at(grid, p);
    Vec<T, Dim> wanted = p.impulse, change;
    for (std::size_t c = 0; c < Dim; ++c) wanted[c] -= (v[c] - T(moving[c])) / p.mobility;
    wanted = lawful(p, wanted);
    for (std::size_t c = 0; c < Dim; ++c) change[c] = wanted[c] - p.impulse[c];
    push(grid, p, change);
    p.impulse = wanted;
    p.changed = dot<T, Dim>(change, change) * p.mobility * p.mobility;
  }

  /// To and fro over the points. Most settle in a few sweeps, after which only the others are asked, and all
  /// once more at the end.
  void sweep_to_rest(Grid<T, Dim>& grid, double time, const T& driven) {
    const T enough = T(tolerance) * driven * T(tolerance) * driven;
    bool all = true;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      all = all || sweep < full_sweeps || sweep == most_sweeps - 1;
      T worst(0);
      for (std::size_t i = 0; i < touched_.size(); ++i) {
        Point& p = *touched_[sweep % 2 == 0 ? i : touched_.size() - 1 - i];
        if (!all && !(p.changed > enough)) continue;
        relax(grid, p, time);
        if (worst < p.changed) worst = p.changed;
      }
      const bool settled = !(worst > enough);
      if (settled && all) break;
      all = settled;
    }
  }

  std::vector<Wall> walls_;
  std::vector<T> friction_;
  double cell_;
  std::array<AxisBounds, 3> bounds_;
  std::vector<Point> points_;
  std::vector<Point*> touched_;
  double placed_at_ = -1.0, looked_at_ = 0.0;  ///< s
  std::vector<Seen> seen_;                     ///< by node
};

}  // namespace flowrest::mpm::plain
