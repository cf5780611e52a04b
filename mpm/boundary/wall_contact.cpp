#include "mpm/boundary/wall_contact.h"

#include <algorithm>
#include <cmath>

#include "mpm/transfer/shape.h"

namespace flowrest::mpm {

namespace {

/// Sweeps at most, and the share of the step's driving speed at which they end. Started from the last step's
/// forces, a body at rest needs one or two.
constexpr int most_sweeps = 12;
constexpr double tolerance = 5e-3;
/// Weights of nodes that are light beside this share of the heaviest around a point fade with their mass. At
/// the edge of a body a light node would take up the whole constraint, at many times the body's speed, and
/// hold nothing. In a filled cell it moves the place at which the wall holds the body a little into the body:
/// at 0.05 a duct of five cells flows another 8 % slower than at 0.01. Linear functions, whose nodes behind
/// a wall are heavier, do not gain by less.
constexpr double light_share_quadratic = 0.01, light_share_linear = 0.05;
constexpr double smallest_share = 1e-12;

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

}  // namespace

/// Whether a place lies behind a plane along the grid, where only an image of it is computed.
template <class T>
bool WallContact<T>::is_mirrored(const Vector& place) const {
  constexpr double round_off = 1e-9;
  for (std::size_t a = 0; a < static_cast<std::size_t>(grid_.dimension); ++a) {
    const AxisBounds& b = grid_.bounds[a];
    const double cells = place[a] / grid_.cell;
    if (b.lower != PlaneWall::none && cells < b.lower_cell - round_off) return true;
    if (b.upper != PlaneWall::none && cells > b.upper_cell + round_off) return true;
  }
  return false;
}

template <class T>
WallContact<T>::WallContact(const Grid& grid, const std::vector<Wall>& walls) : grid_(grid), walls_(walls) {
  for (std::size_t w = 0; w < walls_.size(); ++w)
    for (const SurfacePoint& at : walls_[w].shape->surface(grid_.cell)) {
      if (is_mirrored(at.place)) continue;
      Point p;
      p.wall = static_cast<std::uint32_t>(w);
      p.at = at;
      points_.push_back(p);
    }
}

/// Adds what a point takes from a node; false where the node does not exist.
template <class T>
bool WallContact<T>::add_entry(const SparseBlocks& blocks, const int (&node)[3], double weight,
                               std::vector<Entry>& to) const {
  int n[3] = {node[0], node[1], node[2]};
  double sign[3] = {1.0, 1.0, 1.0};
  for (int a = 0; a < grid_.dimension; ++a) {
    const AxisBounds& bounds = grid_.bounds[static_cast<std::size_t>(a)];
    for (const bool upper : {false, true}) {
      const PlaneWall wall = upper ? bounds.upper : bounds.lower;
      if (wall == PlaneWall::none) continue;
      const int face = upper ? bounds.upper_cell : bounds.lower_cell;
      const bool behind = grid_.quadratic ? (upper ? n[a] > face : n[a] <= face) : n[a] == face;
      if (!behind) continue;
      for (int c = 0; c < grid_.dimension; ++c)
        if (wall == PlaneWall::no_slip || c == a) sign[c] *= grid_.quadratic ? -1.0 : 0.0;
      if (grid_.quadratic) n[a] = 2 * face + 1 - n[a];
    }
  }
  std::array<std::int32_t, 3> block{};
  int local = 0;
  for (int a = 0; a < grid_.dimension; ++a) {
    block[static_cast<std::size_t>(a)] = floor_divide(n[a], block_edge);
    local = local * block_edge + n[a] - block_edge * block[static_cast<std::size_t>(a)];
  }
  const std::uint32_t slot = blocks.slot_of(block);
  if (slot == no_slot) return false;
  const auto cells = static_cast<std::size_t>(power(block_edge, grid_.dimension));
  const std::size_t record_of_node =
      (static_cast<std::size_t>(slot) * cells + static_cast<std::size_t>(local)) * node_values;
  const auto same =
      std::find_if(to.begin(), to.end(), [&](const Entry& e) { return e.record == record_of_node; });
  Entry& entry = same == to.end() ? to.emplace_back(Entry{record_of_node, {}, {}, T(0)}) : *same;
  for (std::size_t c = 0; c < 3; ++c) entry.weight[c] += static_cast<T>(weight * sign[c]);
  return true;
}

template <class T>
void WallContact<T>::find_entries(const SparseBlocks& blocks, Point& p) {
  const Wall& wall = walls_[p.wall];
  const Vector shift = wall.motion.displacement(time_);
  const int nodes = grid_.quadratic ? Quadratic::nodes : Linear::nodes;
  int cell[3] = {0, 0, 0};
  double weight[3][3] = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  for (int a = 0; a < grid_.dimension; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double x = (p.at.place[axis] + shift[axis]) / grid_.cell;
    // On the cell before the wall where the point lies on a face: that one exists where there is material.
    constexpr double inwards = 1e-9;
    cell[a] = static_cast<int>(std::floor(x + inwards * p.at.normal[axis]));
    for (int n = 0; n < nodes; ++n)
      weight[a][n] = grid_.quadratic ? Quadratic::weight(n, x - cell[a]) : Linear::weight(n, x - cell[a]);
  }
  fresh_.clear();
  double missing = 0.0;
  const int depth = grid_.dimension == 3 ? nodes : 1;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j)
      for (int k = 0; k < depth; ++k) {
        const int node[3] = {cell[0] + i, cell[1] + j, cell[2] + k};
        const double w = weight[0][i] * weight[1][j] * weight[2][k];
        constexpr double nothing = 1e-12;  // a plane along the grid sees two rows of nodes, not three
        if (w < nothing) continue;
        if (!add_entry(blocks, node, w, fresh_)) missing += w;
      }
  p.first = entries_.size();
  p.count = fresh_.size();
  p.missing = static_cast<T>(missing);
  entries_.insert(entries_.end(), fresh_.begin(), fresh_.end());
}

template <class T>
void WallContact<T>::place(const SparseBlocks& blocks, double time) {
  bool anything_new = known_slots_ != blocks.slot_count() || time_ < 0.0;
  for (const Wall& wall : walls_) {
    anything_new |= wall.motion.displacement(time) != wall.motion.displacement(time_);
    anything_new |= wall.stands(time) != wall.stands(time_);
  }
  time_ = time;
  if (!anything_new) return;
  known_slots_ = blocks.slot_count();
  entries_.clear();
  for (Point& p : points_) {
    p.stands = walls_[p.wall].stands(time);
    p.count = 0;
    if (p.stands) find_entries(blocks, p);
  }
}

template <class T>
void WallContact<T>::gather_mobilities(const T* nodes, double step) {
  const T light_share = static_cast<T>(grid_.quadratic ? light_share_quadratic : light_share_linear);
  touched_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& p = points_[i];
    T heaviest = T(0);
    Entry* const entries = entries_.data() + p.first;
    for (std::size_t e = 0; e < p.count; ++e) heaviest = std::max(heaviest, nodes[entries[e].record]);
    p.touched = p.stands && heaviest > T(0);
    if (!p.touched) continue;
    T before = p.missing, after = T(0), mobility[3] = {};
    for (std::size_t e = 0; e < p.count; ++e) {
      const T mass = nodes[entries[e].record];
      const T fading = mass / (mass + light_share * heaviest);
      entries[e].per_mass = mass > T(smallest_share) * heaviest ? T(1) / mass : T(0);
      // Shape functions sum to one; so do what is left of them, but for folded nodes, whose sum stays.
      T largest = T(0);
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(entries[e].weight[c]));
      before += largest;
      after += largest * fading;
      for (int c = 0; c < 3; ++c) entries[e].effective[c] = entries[e].weight[c] * fading;
    }
    for (std::size_t e = 0; e < p.count; ++e)
      for (int c = 0; c < grid_.dimension; ++c) {
        T& weight = entries[e].effective[c];
        weight *= before / after;
        mobility[c] += weight * weight * entries[e].per_mass;
      }
    // The largest for all directions: they differ only beside folded nodes, where a smaller one errs on the
    // side of more sweeps.
    p.mobility = std::max({mobility[0], mobility[1], mobility[2]});
    p.touched = p.mobility > T(0);
    for (int c = 0; c < 3; ++c) p.impulse[c] = static_cast<T>(p.force[c] * step);
    if (p.touched) touched_.push_back(i);
  }
}

template <class T>
void WallContact<T>::velocity_at(const Point& p, const T* nodes, T (&v)[3]) const {
  for (T& component : v) component = T(0);
  const Entry* const entries = entries_.data() + p.first;
  for (std::size_t e = 0; e < p.count; ++e) {
    const T* node = nodes + entries[e].record + 1;
    for (int c = 0; c < grid_.dimension; ++c) v[c] += entries[e].effective[c] * node[c];
  }
}

template <class T>
void WallContact<T>::push(const Point& p, T* nodes, const T (&impulse)[3], int record_offset) const {
  const Entry* const entries = entries_.data() + p.first;
  for (std::size_t e = 0; e < p.count; ++e) {
    T* node = nodes + entries[e].record + record_offset + 1;
    for (int c = 0; c < grid_.dimension; ++c)
      node[c] += entries[e].effective[c] * impulse[c] * entries[e].per_mass;
  }
}

/// The impulse after which a point moves with its wall, and how much of it is along the normal.
template <class T>
void WallContact<T>::wanted_impulse(const Point& p, const T* nodes, T (&wanted)[3], T& normal) const {
  T v[3];
  velocity_at(p, nodes, v);
  const Vector moving = walls_[p.wall].motion.velocity_at(time_);
  normal = T(0);
  for (std::size_t c = 0; c < 3; ++c) {
    wanted[c] = p.impulse[c] - (v[c] - static_cast<T>(moving[c])) / p.mobility;
    normal += wanted[c] * static_cast<T>(p.at.normal[c]);
  }
}

template <class T>
T WallContact<T>::change_impulse(Point& p, T* nodes, const T (&wanted)[3]) const {
  T change[3], size = T(0);
  for (int c = 0; c < 3; ++c) {
    change[c] = c < grid_.dimension ? wanted[c] - p.impulse[c] : T(0);
    p.impulse[c] += change[c];
    size += change[c] * change[c];
  }
  if (size > T(0)) push(p, nodes, change, 0);
  return std::sqrt(size) * p.mobility;
}

template <class T>
T WallContact<T>::relax(Point& p, T* nodes) const {
  const Wall& wall = walls_[p.wall];
  T wanted[3], normal;
  wanted_impulse(p, nodes, wanted, normal);
  p.pressed = p.stuck = true;
  if (wall.contact != Contact::stick) {
    T along[3], square = T(0);
    for (std::size_t c = 0; c < 3; ++c) {
      along[c] = wanted[c] - normal * static_cast<T>(p.at.normal[c]);
      square += along[c] * along[c];
    }
    const T pressed = std::max(normal, T(0));
    const T limit = wall.contact == Contact::slip ? T(0) : static_cast<T>(wall.friction) * pressed;
    const T length = std::sqrt(square);
    const T share = length > limit ? limit / length : T(1);
    for (std::size_t c = 0; c < 3; ++c)
      wanted[c] = pressed * static_cast<T>(p.at.normal[c]) + share * along[c];
    p.pressed = normal > T(0);
    p.stuck = p.pressed && share == T(1) && wall.contact == Contact::friction;
  }
  return change_impulse(p, nodes, wanted);
}

template <class T>
T WallContact<T>::relax_as_before(Point& p, T* nodes) const {
  if (!p.pressed) return T(0);
  T wanted[3], normal;
  wanted_impulse(p, nodes, wanted, normal);
  if (!p.stuck)
    for (std::size_t c = 0; c < 3; ++c) wanted[c] = normal * static_cast<T>(p.at.normal[c]);
  return change_impulse(p, nodes, wanted);
}

template <class T>
void WallContact<T>::sweep_to_rest(T* nodes, double drive, Relax how) {
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    T worst = T(0);
    if (sweep % 2 == 0) {
      for (const std::size_t i : touched_) worst = std::max(worst, (this->*how)(points_[i], nodes));
    } else {
      for (std::size_t n = touched_.size(); n-- > 0;)
        worst = std::max(worst, (this->*how)(points_[touched_[n]], nodes));
    }
    if (worst <= static_cast<T>(tolerance * drive)) break;
  }
}

template <class T>
double WallContact<T>::apply(T* nodes, double step, double drive) {
  gather_mobilities(nodes, step);
  for (const std::size_t i : touched_) push(points_[i], nodes, points_[i].impulse, 0);
  sweep_to_rest(nodes, drive, &WallContact::relax);
  double work = 0.0;
  for (Point& p : points_)
    for (double& f : p.force) f = 0.0;
  for (const std::size_t i : touched_) {
    Point& p = points_[i];
    // With the velocities that strain and move the material, as the stress does its work.
    T v[3];
    velocity_at(p, nodes, v);
    for (std::size_t c = 0; c < 3; ++c) {
      work += static_cast<double>(p.impulse[c]) * static_cast<double>(v[c]);
      p.force[c] = static_cast<double>(p.impulse[c]) / step;
    }
    push(p, nodes, p.impulse, record);
  }
  return work;
}

template <class T>
void WallContact<T>::apply_to_remapped(T* nodes, double step, double drive) {
  gather_mobilities(nodes, step);
  for (const std::size_t i : touched_)
    for (T& component : points_[i].impulse) component = T(0);
  sweep_to_rest(nodes, drive, &WallContact::relax_as_before);
}

template <class T>
Vector WallContact<T>::force(std::size_t wall) const {
  Vector sum{};
  for (const Point& p : points_)
    if (p.wall == wall)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += p.force[c];
  return sum;
}

template <class T>
std::vector<double> WallContact<T>::forces() const {
  std::vector<double> all;
  for (const Point& p : points_) all.insert(all.end(), p.force, p.force + 3);
  return all;
}

template <class T>
void WallContact<T>::set_forces(const std::vector<double>& all) {
  for (std::size_t i = 0; i < points_.size() && 3 * i + 2 < all.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) points_[i].force[c] = all[3 * i + c];
}

template class WallContact<float>;
template class WallContact<double>;

}  // namespace flowrest::mpm
