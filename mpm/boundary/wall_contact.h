#pragma once

#include <cstdint>
#include <vector>

#include "mpm/boundary/contact_points.h"
#include "mpm/boundary/walls.h"
#include "mpm/solver/sparse_blocks.h"

namespace flowrest::mpm {

/// Contact of the grid with walls of any shape.
///
/// A wall acts at points of its surface, at most a cell apart. At each it holds the velocity that the shape
/// functions give there, v = sum N_i v_i, and its impulse goes to the nodes with the same N_i: so the whole
/// reaction of the wall is known point by point, whichever nodes carry it, and limits the friction there
/// (held at nodes instead, a quadratic function's reaction would be shared out over nodes on both sides of
/// the wall, and so would its limit). The impulses of all points are found together, by projected
/// Gauss-Seidel sweeps that start from the last step's forces, in a fixed order: the same for any number of
/// threads.
///
/// The nodes that points see are copied side by side for the sweeps, which the kernels do (contact_sweeps.h).
///
/// Nodes behind a plane wall along the grid (plane_walls.h) are folded onto their images: their weights go to
/// the image with the sign of the mirrored body.
template <class T>
class WallContact {
 public:
  struct Grid {
    int dimension = 2;
    bool quadratic = true;
    double cell = 0.0;  ///< m
    std::array<AxisBounds, 3> bounds{};
  };
  WallContact(const Grid&, const std::vector<Wall>&, const ContactKernels<T>&);

  /// Notes which walls stand and where they are at `time`, and which nodes exist.
  void place(const SparseBlocks&, double time);

  /// Holds the grid's new velocities to the walls. `nodes` are records as update_nodes leaves them, `drive`
  /// is the speed that the driving force gives in the step (m/s), from which the sweeps' tolerance follows.
  /// Returns the work done by the walls on the material, J.
  double apply(T* nodes, double step, double drive);

  /// The same for velocities mapped to the grid a second time (linear functions). What the mapping smoothed
  /// is held as the step's own contact was: pressed points stay on the wall both ways (held one way only,
  /// noise would be rectified and pump the body up), stuck ones stay stuck, the rest is left alone. Forces
  /// stay.
  void apply_to_remapped(T* nodes, double drive);

  /// Sum over a wall's points of the force it put on the material in the last step, N.
  Vector force(std::size_t wall) const;

  const std::vector<Wall>& walls() const { return walls_; }
  double time() const { return time_; }

  /// Forces at all points, three numbers each, for checkpoints. N
  std::vector<double> forces() const;
  void set_forces(const std::vector<double>&);

 private:
  enum class Room : std::uint8_t { none, plain, folded };
  struct Point {
    std::uint32_t wall = 0;
    SurfacePoint at;
    Room room = Room::none;               ///< for its entries
    std::array<std::int32_t, 3> block{};  ///< that it lies in; its nodes may be in the next ones, too
    double force[3]{};                    ///< N, of the last step
  };
  /// What a point takes from a node, per velocity component: a folded node's weight may change sign.
  struct Entry {
    std::uint32_t node;
    double weight[3];
  };

  bool is_mirrored(const Vector& place) const;
  bool is_near(const Point&, const std::array<std::int32_t, 3>& block) const;
  void find_entries(const SparseBlocks&, std::size_t point);
  bool add_entry(const SparseBlocks&, const int (&node)[3], double weight);
  void keep_entries(std::size_t point);
  void take_up(const T* nodes);
  void hand_back(T* nodes, bool change_too) const;
  void sweep_to_rest(double drive, Relaxation);
  ContactView<T> view();

  Grid grid_;
  std::vector<Wall> walls_;
  ContactKernels<T> kernels_;
  std::vector<Point> points_;
  std::vector<ContactPoint<T>> contact_points_;  ///< the same
  std::vector<std::uint32_t> seen_, touched_;  ///< those that nodes lie around, and of these those with mass
  std::vector<Entry> fresh_;
  std::vector<std::uint32_t> node_of_entry_;
  std::vector<T> weights_, effective_, responses_;
  std::vector<std::uint32_t> index_of_node_;  ///< by slot and place in the block
  std::vector<std::size_t> record_of_node_;   ///< offset of its record
  std::vector<T> velocity_, velocity_before_, mass_, per_mass_;
  std::vector<bool> moved_;
  std::size_t known_slots_ = 0;
  double time_ = -1.0;
};

extern template class WallContact<float>;
extern template class WallContact<double>;

}  // namespace flowrest::mpm
