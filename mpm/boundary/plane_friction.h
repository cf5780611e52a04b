#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mpm/solver/sparse_blocks.h"

namespace flowrest::mpm {

/// Coulomb's friction on plane walls along the grid: they hold what presses them as walls of no slip do
/// (plane_walls.h), up to a limit, and let go of what pulls off them.
///
/// Quadratic functions: of the velocity at the wall half comes from the first node inside, half from the
/// ghost node behind it. An impulse J of the wall is shared by the two, so that a wall that holds needs J =
/// -4 m1 mg / (m1 + mg) v_wall, v_wall = (v1 + vg) / 2, after which the ghost node moves as the mirrored body
/// does: what folding the ghost node onto its image gives as well. Linear functions have a node on the wall,
/// and J = -m v. Along the wall J is limited to the friction coefficient times its part across the wall. The
/// share of J that is left is how far the wall holds: 1 where it does not slip. In that share the nodes'
/// velocities before the step are the mirrored body's too, and the transfer's error beside a wall is taken
/// out (wall_transfer_correction). What holds is solved node by node: no wall's node belongs to another pair
/// of the same wall, so that the limit is exact, and the result the same for any number of threads.
template <class T>
class PlaneFriction {
 public:
  struct Grid {
    int dimension = 2;
    bool quadratic = true;
    std::array<AxisBounds, 3> bounds{};
  };
  explicit PlaneFriction(const Grid& grid) : grid_(grid) {}

  /// Whether any plane wall has friction.
  static bool is_needed(const Grid&);

  /// Notes which nodes exist; what holds is undone.
  void place(const SparseBlocks&);

  /// Holds the grid's new velocities. `nodes` are records as update_nodes leaves them.
  void hold(T* nodes);
  /// The same once more, after other walls have changed the velocities: the two impulses together obey the
  /// law.
  void hold_again(T* nodes);
  /// Takes the transfer's error out of the first nodes, writes how far each is held to `holds` (as Grid of
  /// layout.h has them) and returns the work of the walls on the material in this step, J.
  double finish(T* nodes, T* holds);

  /// The same for velocities mapped to the grid a second time (linear functions): what was pressed stays on
  /// the wall, what was held stays held.
  void hold_remapped(T* nodes) const;

  /// Force of all these walls on the material in the last step of `step` seconds, N.
  std::array<double, 3> force(double step) const;

 private:
  /// A node that a wall holds, and the ghost node behind the wall.
  struct Pair {
    std::size_t first, ghost, second;  ///< offsets of records; second: of the next node off the wall
    std::size_t node;                  ///< index of the first node
    int axis;
    double inwards;  ///< 1 for a lower wall, -1 for an upper one
    double friction;
    double mass = 0.0, ghost_mass = 0.0;  ///< kg, in this step
    double impulse[3]{};                  ///< kg m/s, on the material
    double pressing = 0.0;                ///< kg m/s that the wall gives the material across itself
    double held = 0.0;                    ///< share of what would hold it along the wall, 0 to 1
    bool pressed = false;
  };
  static constexpr std::size_t absent = ~std::size_t{0};

  void find_pairs(const SparseBlocks&, std::uint32_t slot, int axis, bool upper);
  void relax(Pair&, T* nodes, bool again) const;
  double value_at_wall(const Pair&, const T* nodes, std::size_t offset, int component) const;
  void mirror(const Pair&, T* nodes, int component) const;
  void push(const Pair&, T* nodes, int component, double impulse) const;
  void correct_transfer(const Pair&, T* nodes) const;

  Grid grid_;
  std::vector<Pair> pairs_;
  std::size_t known_slots_ = 0;
};

extern template class PlaneFriction<float>;
extern template class PlaneFriction<double>;

}  // namespace flowrest::mpm
