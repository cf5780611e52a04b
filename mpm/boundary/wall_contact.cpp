#include "mpm/boundary/wall_contact.h"

#include <algorithm>
#include <cmath>

#include "mpm/transfer/shape.h"

namespace flowrest::mpm {

namespace {

/// Sweeps at most, and the share of the step's driving speed at which they end. Started from the last step's
/// forces, a body at rest needs one or two.
constexpr int most_sweeps = 12, full_sweeps = 4;
constexpr double tolerance = 5e-3;
/// Weights of nodes that are light beside this share of the heaviest around a point fade with their mass. At
/// the edge of a body a light node would take up the whole constraint, at many times the body's speed, and
/// hold nothing. In a filled cell it moves the place at which the wall holds the body a little into the body:
/// at 0.05 a duct of five cells flows another 8 % slower than at 0.01. Linear functions, whose nodes behind
/// a wall are heavier, do not gain by less.
constexpr double light_share_quadratic = 0.01, light_share_linear = 0.05;
constexpr std::uint32_t no_node = ~0u;

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
WallContact<T>::WallContact(const Grid& grid, const std::vector<Wall>& walls,
                            const ContactKernels<T>& kernels)
    : grid_(grid), walls_(walls), kernels_(kernels) {
  for (std::size_t w = 0; w < walls_.size(); ++w)
    for (const SurfacePoint& at : walls_[w].shape->surface(grid_.cell)) {
      if (is_mirrored(at.place)) continue;
      Point p;
      p.wall = static_cast<std::uint32_t>(w);
      p.at = at;
      points_.push_back(p);
      ContactPoint<T>& contact = contact_points_.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) contact.normal[c] = static_cast<T>(at.normal[c]);
      contact.sticks = walls_[w].contact == Contact::stick;
      contact.friction = walls_[w].contact == Contact::friction ? static_cast<T>(walls_[w].friction) : T(0);
      contact.missing = T(1);
    }
}

/// Adds what a point takes from a node; false where the node does not exist.
template <class T>
bool WallContact<T>::add_entry(const SparseBlocks& blocks, const int (&node)[3], double weight) {
  int n[3] = {node[0], node[1], node[2]};
  double sign[3] = {1.0, 1.0, 1.0};
  for (int a = 0; a < grid_.dimension; ++a) {
    const AxisBounds& bounds = grid_.bounds[static_cast<std::size_t>(a)];
    for (const bool upper : {false, true}) {
      const PlaneWall wall = upper ? bounds.upper : bounds.lower;
      // Nodes behind a wall of friction are the body's own.
      if (wall == PlaneWall::none || wall == PlaneWall::friction) continue;
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
  const std::size_t place = static_cast<std::size_t>(slot) * cells + static_cast<std::size_t>(local);
  std::uint32_t& index = index_of_node_[place];
  if (index == no_node) {
    index = static_cast<std::uint32_t>(record_of_node_.size());
    record_of_node_.push_back(place * node_values);
  }
  const auto same =
      std::find_if(fresh_.begin(), fresh_.end(), [&](const Entry& e) { return e.node == index; });
  Entry& entry = same == fresh_.end() ? fresh_.emplace_back(Entry{index, {}}) : *same;
  for (std::size_t c = 0; c < 3; ++c) entry.weight[c] += weight * sign[c];
  return true;
}

/// Finds the nodes around a point.
template <class T>
void WallContact<T>::find_entries(const SparseBlocks& blocks, std::size_t point) {
  Point& p = points_[point];
  const Wall& wall = walls_[p.wall];
  fresh_.clear();
  contact_points_[point].count = 0;
  contact_points_[point].missing = T(0);
  if (!wall.stands(time_)) return;
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
    p.block[axis] = floor_divide(cell[a], block_edge);
    for (int n = 0; n < nodes; ++n)
      weight[a][n] = grid_.quadratic ? Quadratic::weight(n, x - cell[a]) : Linear::weight(n, x - cell[a]);
  }
  double missing = 0.0;
  const int depth = grid_.dimension == 3 ? nodes : 1;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j)
      for (int k = 0; k < depth; ++k) {
        const int node[3] = {cell[0] + i, cell[1] + j, cell[2] + k};
        const double w = weight[0][i] * weight[1][j] * weight[2][k];
        constexpr double nothing = 1e-12;  // a plane along the grid sees two rows of nodes, not three
        if (w < nothing) continue;
        if (!add_entry(blocks, node, w)) missing += w;
      }
  contact_points_[point].missing = static_cast<T>(missing);
  keep_entries(point);
}

/// Writes a point's fresh entries to where it has room for them.
template <class T>
void WallContact<T>::keep_entries(std::size_t point) {
  Room& room = points_[point].room;
  ContactPoint<T>& p = contact_points_[point];
  p.count = static_cast<std::uint32_t>(fresh_.size());
  p.folded = std::any_of(fresh_.begin(), fresh_.end(), [](const Entry& e) {
    return e.weight[0] != e.weight[1] || e.weight[1] != e.weight[2];
  });
  const Room needed = fresh_.empty() ? Room::none : p.folded ? Room::folded : Room::plain;
  if (room < needed) {
    room = needed;
    const auto most =
        static_cast<std::size_t>(power(grid_.quadratic ? Quadratic::nodes : Linear::nodes, grid_.dimension));
    p.first = static_cast<std::uint32_t>(node_of_entry_.size());
    p.first_weight = static_cast<std::uint32_t>(weights_.size());
    node_of_entry_.resize(node_of_entry_.size() + most);
    for (auto* of : {&weights_, &effective_, &responses_})
      of->resize(of->size() + most * (p.folded ? record : 1));
  }
  for (std::size_t e = 0; e < fresh_.size(); ++e) {
    node_of_entry_[p.first + e] = fresh_[e].node;
    if (p.folded) {
      for (std::size_t c = 0; c < 3; ++c)
        weights_[p.first_weight + record * e + c] = static_cast<T>(fresh_[e].weight[c]);
    } else {
      weights_[p.first_weight + e] = static_cast<T>(fresh_[e].weight[0]);
    }
  }
}

/// Whether a point may see nodes of a block.
template <class T>
bool WallContact<T>::is_near(const Point& p, const std::array<std::int32_t, 3>& block) const {
  for (std::size_t a = 0; a < static_cast<std::size_t>(grid_.dimension); ++a)
    if (std::abs(p.block[a] - block[a]) > 1 && !grid_.bounds[a].periodic) return false;
  return true;
}

template <class T>
void WallContact<T>::place(const SparseBlocks& blocks, double time) {
  bool anything_new = known_slots_ != blocks.slot_count();
  moved_.assign(walls_.size(), time_ < 0.0);
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    const Wall& wall = walls_[w];
    if (wall.motion.displacement(time) != wall.motion.displacement(time_) ||
        wall.stands(time) != wall.stands(time_))
      moved_[w] = true;
    anything_new |= moved_[w];
  }
  time_ = time;
  if (!anything_new) return;
  std::vector<std::array<std::int32_t, 3>> new_blocks;
  for (; known_slots_ < blocks.slot_count(); ++known_slots_)
    new_blocks.push_back(blocks.block(static_cast<std::uint32_t>(known_slots_)));
  index_of_node_.resize(known_slots_ * static_cast<std::size_t>(power(block_edge, grid_.dimension)), no_node);
  seen_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ContactPoint<T>& p = contact_points_[i];
    const auto may_see = [&](const auto& block) { return is_near(points_[i], block); };
    if (moved_[points_[i].wall] ||
        (p.missing > T(0) && std::any_of(new_blocks.begin(), new_blocks.end(), may_see)))
      find_entries(blocks, i);
    if (p.count > 0) seen_.push_back(static_cast<std::uint32_t>(i));
  }
}

template <class T>
ContactView<T> WallContact<T>::view() {
  return {grid_.dimension,  contact_points_.data(), node_of_entry_.data(),
          weights_.data(),  effective_.data(),      responses_.data(),
          velocity_.data(), mass_.data(),           per_mass_.data()};
}

/// Copies the nodes that points see, finds which points have mass around them, and what a push there does.
template <class T>
void WallContact<T>::take_up(const T* nodes) {
  const std::size_t count = record_of_node_.size();
  velocity_.resize(record * count);
  velocity_before_.resize(record * count);
  mass_.resize(count);
  per_mass_.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    const T* from = nodes + record_of_node_[n];
    mass_[n] = from[0];
    per_mass_[n] = from[0] > T(0) ? T(1) / from[0] : T(0);
    for (std::size_t c = 0; c < 3; ++c) velocity_[record * n + c] = from[1 + c];
  }
  velocity_before_ = velocity_;
  kernels_.weigh(view(), static_cast<T>(grid_.quadratic ? light_share_quadratic : light_share_linear),
                 seen_.data(), seen_.size());
  touched_.clear();
  for (const std::uint32_t i : seen_)
    if (contact_points_[i].mobility > T(0)) touched_.push_back(i);
}

/// Writes the new velocities to the nodes, and what has changed to their second records.
template <class T>
void WallContact<T>::hand_back(T* nodes, bool change_too) const {
  for (std::size_t n = 0; n < record_of_node_.size(); ++n) {
    T* const to = nodes + record_of_node_[n];
    for (std::size_t c = 0; c < 3; ++c) {
      const T v = velocity_[record * n + c];
      to[1 + c] = v;
      if (change_too) to[record + 1 + c] += v - velocity_before_[record * n + c];
    }
  }
}

/// Most points settle in a few sweeps, after which only the others are asked, and all once more at the end.
template <class T>
void WallContact<T>::sweep_to_rest(double drive, Relaxation how) {
  const auto enough = static_cast<T>(tolerance * drive * tolerance * drive);
  bool all = true;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    all |= sweep < full_sweeps || sweep == most_sweeps - 1;
    const T worst =
        kernels_.sweep(view(), {how, sweep % 2 != 0, all ? T(-1) : enough}, touched_.data(), touched_.size());
    const bool settled = worst <= enough;
    if (settled && all) break;
    all = settled;
  }
}

template <class T>
double WallContact<T>::apply(T* nodes, double step, double drive) {
  take_up(nodes);
  for (const std::uint32_t i : touched_) {
    const Vector moving = walls_[points_[i].wall].motion.velocity_at(time_);
    for (std::size_t c = 0; c < 3; ++c) {
      contact_points_[i].wall_velocity[c] = static_cast<T>(moving[c]);
      contact_points_[i].impulse[c] = static_cast<T>(points_[i].force[c] * step);
    }
  }
  kernels_.push(view(), touched_.data(), touched_.size());
  sweep_to_rest(drive, Relaxation::lawful);
  for (Point& p : points_)
    for (double& f : p.force) f = 0.0;
  for (const std::uint32_t i : touched_)
    for (std::size_t c = 0; c < 3; ++c)
      points_[i].force[c] = static_cast<double>(contact_points_[i].impulse[c]) / step;
  hand_back(nodes, true);
  // With the velocities that strain and move the material, as the stress does its work.
  return kernels_.work(view(), touched_.data(), touched_.size());
}

template <class T>
void WallContact<T>::apply_to_remapped(T* nodes, double drive) {
  take_up(nodes);
  for (const std::uint32_t i : touched_)
    for (T& component : contact_points_[i].impulse) component = T(0);
  sweep_to_rest(drive, Relaxation::as_before);
  hand_back(nodes, false);
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
