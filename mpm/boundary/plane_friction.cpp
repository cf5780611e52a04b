#include "mpm/boundary/plane_friction.h"

#include <algorithm>
#include <cmath>

#include "mpm/boundary/wall_transfer.h"

namespace flowrest::mpm {

namespace {

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

}  // namespace

template <class T>
bool PlaneFriction<T>::is_needed(const Grid& grid) {
  return std::any_of(grid.bounds.begin(), grid.bounds.end(), [](const AxisBounds& b) {
    return b.lower == PlaneWall::friction || b.upper == PlaneWall::friction;
  });
}

template <class T>
void PlaneFriction<T>::place(const SparseBlocks& blocks) {
  if (known_slots_ == blocks.slot_count()) return;
  known_slots_ = blocks.slot_count();
  pairs_.clear();
  // One axis after the other, so that what two walls share in a corner is held in an order of its own.
  for (int a = 0; a < grid_.dimension; ++a)
    for (const bool upper : {false, true}) {
      const AxisBounds& b = grid_.bounds[static_cast<std::size_t>(a)];
      if ((upper ? b.upper : b.lower) != PlaneWall::friction) continue;
      for (std::uint32_t slot = 0; slot < known_slots_; ++slot) find_pairs(blocks, slot, a, upper);
    }
}

/// Pairs whose first node belongs to a block of nodes.
template <class T>
void PlaneFriction<T>::find_pairs(const SparseBlocks& blocks, std::uint32_t slot, int axis, bool upper) {
  const auto along = static_cast<std::size_t>(axis);
  const AxisBounds& bounds = grid_.bounds[along];
  const int face = upper ? bounds.upper_cell : bounds.lower_cell;
  // Node n of the quadratic functions lies in the middle of cell n - 1, of the linear ones at its lower face.
  const int ghost = upper ? face + 1 : face, image = 2 * face + 1 - ghost;
  const int first = grid_.quadratic ? image : face, second = upper ? first - 1 : first + 1;
  const auto& block = blocks.block(slot);
  const int dim = grid_.dimension;
  if (first < block[along] * block_edge || first >= (block[along] + 1) * block_edge) return;
  const auto slot_with = [&](int node) {
    auto other = block;
    other[along] = floor_divide(node, block_edge);
    return blocks.slot_of(other);
  };
  const auto cells = static_cast<std::size_t>(power(block_edge, dim));
  int stride = 1;
  for (int a = dim - 1; a > axis; --a) stride *= block_edge;
  // Index of the node of that row along the axis which lies beside `local`, a node of the row at nought.
  const auto index = [&](std::uint32_t of_slot, int local, int row) {
    const int in_block = row - block_edge * floor_divide(row, block_edge);
    return static_cast<std::size_t>(of_slot) * cells + static_cast<std::size_t>(local + in_block * stride);
  };
  const std::uint32_t ghost_slot = grid_.quadratic ? slot_with(ghost) : no_slot;
  const std::uint32_t second_slot = grid_.quadratic ? slot_with(second) : no_slot;
  if (grid_.quadratic && ghost_slot == no_slot) return;
  for (int local = 0; local < static_cast<int>(cells); ++local) {
    if (local / stride % block_edge != 0) continue;
    Pair p{};
    p.node = index(slot, local, first);
    p.first = p.node * node_values;
    p.ghost = ghost_slot == no_slot ? absent : index(ghost_slot, local, ghost) * node_values;
    p.second = second_slot == no_slot ? absent : index(second_slot, local, second) * node_values;
    p.axis = axis;
    p.inwards = upper ? -1.0 : 1.0;
    p.friction = upper ? bounds.upper_friction : bounds.lower_friction;
    pairs_.push_back(p);
  }
}

/// A component of a pair's records at the wall: of the velocity, or of its change (`offset` of a record).
template <class T>
double PlaneFriction<T>::value_at_wall(const Pair& p, const T* nodes, std::size_t offset,
                                       int component) const {
  const std::size_t at = offset + 1 + static_cast<std::size_t>(component);
  const double inside = static_cast<double>(nodes[p.first + at]);
  return grid_.quadratic ? 0.5 * (inside + static_cast<double>(nodes[p.ghost + at])) : inside;
}

/// Mirrors a component of both records as a wall of no slip does: they are linear in the momentum that was
/// brought, in that of the step and in that from before.
template <class T>
void PlaneFriction<T>::mirror(const Pair& p, T* nodes, int component) const {
  for (std::size_t r = 0; r < node_values; r += record) {
    T& first = nodes[p.first + r + 1 + static_cast<std::size_t>(component)];
    if (!grid_.quadratic) {
      first = T(0);
      continue;
    }
    T& ghost = nodes[p.ghost + r + 1 + static_cast<std::size_t>(component)];
    const double brought = p.mass * static_cast<double>(first) - p.ghost_mass * static_cast<double>(ghost);
    first = static_cast<T>(brought / (p.mass + p.ghost_mass));
    ghost = -first;
  }
}

/// Adds an impulse (kg m/s) along one component to a pair, once in its velocities and once in their change.
template <class T>
void PlaneFriction<T>::push(const Pair& p, T* nodes, int component, double impulse) const {
  const auto one = [&](std::size_t node, double share_of_impulse, double mass) {
    const T change = static_cast<T>(share_of_impulse / mass);
    for (std::size_t r = 0; r < node_values; r += record)
      nodes[node + r + 1 + static_cast<std::size_t>(component)] += change;
  };
  one(p.first, grid_.quadratic ? 0.5 * impulse : impulse, p.mass);
  if (grid_.quadratic) one(p.ghost, 0.5 * impulse, p.ghost_mass);
}

/// Gives a pair the impulse that its velocities ask for and the law allows.
///
/// What is held is mirrored, also in the velocities before the step, of which particles keep a share: so what
/// the wall gives them across itself is what holds the change of velocity, not the velocity, and that limits
/// the friction. What slides is pushed, and particles lose what friction takes.
template <class T>
void PlaneFriction<T>::relax(Pair& p, T* nodes, bool again) const {
  const int dim = grid_.dimension;
  if (!(p.mass > 0.0) || (grid_.quadratic && !(p.ghost_mass > 0.0))) return;
  // Impulse for a velocity at the wall.
  const double inertia = grid_.quadratic ? 4.0 * p.mass * p.ghost_mass / (p.mass + p.ghost_mass) : p.mass;
  double wanted[3]{}, along_squared = 0.0;
  for (int c = 0; c < dim; ++c) {
    wanted[c] = p.impulse[c] - inertia * value_at_wall(p, nodes, 0, c);
    if (c != p.axis) along_squared += wanted[c] * wanted[c];
  }
  const double pressing =
      std::max(0.0, p.pressing - p.inwards * inertia * value_at_wall(p, nodes, record, p.axis));
  p.pressed = p.inwards * wanted[p.axis] > 0.0;
  p.pressing = p.pressed ? pressing : 0.0;
  const double limit = p.friction * p.pressing, along = std::sqrt(along_squared);
  p.held = !p.pressed ? 0.0 : along > limit ? limit / along : 1.0;
  for (int c = 0; c < dim; ++c) {
    const double share = c == p.axis ? (p.pressed ? 1.0 : 0.0) : p.held;
    const double change = share * wanted[c] - p.impulse[c];
    p.impulse[c] = share * wanted[c];
    if (share == 1.0 && !again) {
      mirror(p, nodes, c);
    } else {
      push(p, nodes, c, change);
    }
  }
}

template <class T>
void PlaneFriction<T>::hold(T* nodes) {
  for (Pair& p : pairs_) {
    p.mass = static_cast<double>(nodes[p.first]);
    p.ghost_mass = p.ghost == absent ? 0.0 : static_cast<double>(nodes[p.ghost]);
    p.held = 0.0;
    p.pressed = false;
    p.pressing = 0.0;
    for (double& c : p.impulse) c = 0.0;
    relax(p, nodes, false);
  }
}

template <class T>
void PlaneFriction<T>::hold_again(T* nodes) {
  for (Pair& p : pairs_) relax(p, nodes, true);
}

/// As correct_wall_transfer does along walls of no slip, in the share in which this one holds: the second
/// difference over ghost, first and second node does not see the velocity at which the wall slips.
template <class T>
void PlaneFriction<T>::correct_transfer(const Pair& p, T* nodes) const {
  if (p.second == absent || !(p.held > 0.0)) return;
  const double known = known_profile(static_cast<double>(nodes[p.second]), p.mass + p.ghost_mass);
  for (int r = 0; r < node_values / record; ++r)
    for (int c = 0; c < grid_.dimension; ++c) {
      const auto at = static_cast<std::size_t>(r * record + 1 + c);
      T &first = nodes[p.first + at], &ghost = nodes[p.ghost + at];
      const T bend = nodes[p.second + at] - T(2) * first + ghost;
      const T correction = static_cast<T>(wall_transfer_correction * known * p.held) * bend;
      first -= correction;
      ghost += correction;
    }
}

template <class T>
double PlaneFriction<T>::finish(T* nodes, T* holds) {
  double work = 0.0;
  for (const Pair& p : pairs_) {
    for (int c = 0; c < grid_.dimension; ++c)
      if (p.pressed) work += p.impulse[c] * value_at_wall(p, nodes, 0, c);
    holds[p.node] = T(0);
  }
  if (grid_.quadratic)
    for (const Pair& p : pairs_) correct_transfer(p, nodes);
  // In a corner the wall that holds more decides.
  for (const Pair& p : pairs_) holds[p.node] = std::max(holds[p.node], static_cast<T>(p.held));
  return work;
}

template <class T>
void PlaneFriction<T>::hold_remapped(T* nodes) const {
  for (const Pair& p : pairs_) {
    if (!p.pressed) continue;
    for (int c = 0; c < grid_.dimension; ++c)
      if (c == p.axis || p.held == 1.0) nodes[p.first + 1 + static_cast<std::size_t>(c)] = T(0);
  }
}

template <class T>
std::array<double, 3> PlaneFriction<T>::force(double step) const {
  std::array<double, 3> sum{};
  for (const Pair& p : pairs_)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += p.impulse[c] / step;
  return sum;
}

template class PlaneFriction<float>;
template class PlaneFriction<double>;

}  // namespace flowrest::mpm
