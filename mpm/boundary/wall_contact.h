#pragma once

#include <cstdint>
#include <vector>

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
  WallContact(const Grid&, const std::vector<Wall>&);

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
  void apply_to_remapped(T* nodes, double step, double drive);

  /// Sum over a wall's points of the force it put on the material in the last step, N.
  Vector force(std::size_t wall) const;

  const std::vector<Wall>& walls() const { return walls_; }
  double time() const { return time_; }

  /// Forces at all points, three numbers each, for checkpoints. N
  std::vector<double> forces() const;
  void set_forces(const std::vector<double>&);

 private:
  /// What a point takes from a node, per velocity component: a folded node's weight may change sign.
  struct Entry {
    std::size_t record;  ///< offset of the node's record
    T weight[3];         ///< of the shape functions
    T effective[3];      ///< of this step: less where the node is light
    T per_mass;          ///< 1/kg, zero where it carries nothing
  };
  struct Point {
    std::uint32_t wall = 0;
    SurfacePoint at;
    bool stands = true;
    std::size_t first = 0, count = 0;     ///< of its entries
    T missing{};                          ///< sum of the weights of nodes that do not exist
    bool touched = false;                 ///< nodes around it carry mass
    T mobility{};                         ///< velocity per impulse, 1/kg
    T impulse[3]{};                       ///< kg m/s
    bool pressed = false, stuck = false;  ///< at the end of the step's contact
    double force[3]{};                    ///< N, of the last step
  };

  bool is_mirrored(const Vector& place) const;
  void find_entries(const SparseBlocks&, Point&);
  bool add_entry(const SparseBlocks&, const int (&node)[3], double weight, std::vector<Entry>&) const;
  void gather_mobilities(const T* nodes, double step);
  /// Corrects one point's impulse to what its velocity asks for and what is allowed; returns the change of
  /// velocity, m/s.
  using Relax = T (WallContact::*)(Point&, T* nodes) const;
  void sweep_to_rest(T* nodes, double drive, Relax);
  T relax(Point&, T* nodes) const;
  T relax_as_before(Point&, T* nodes) const;
  T change_impulse(Point&, T* nodes, const T (&wanted)[3]) const;
  void wanted_impulse(const Point&, const T* nodes, T (&wanted)[3], T& normal) const;
  void velocity_at(const Point&, const T* nodes, T (&v)[3]) const;
  void push(const Point&, T* nodes, const T (&impulse)[3], int record_offset) const;

  Grid grid_;
  std::vector<Wall> walls_;
  std::vector<Point> points_;
  std::vector<Entry> entries_, fresh_;
  std::vector<std::size_t> touched_;
  std::size_t known_slots_ = 0;
  double time_ = -1.0;
};

extern template class WallContact<float>;
extern template class WallContact<double>;

}  // namespace flowrest::mpm
