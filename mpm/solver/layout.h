#pragma once

#include <array>
#include <cstdint>

/// The shared shape of the data: cells in blocks of 4 per axis, particles as a structure of arrays sorted by
/// cell, one private arena of nodes per block. Every stage of the step is written against these views.
namespace flowrest::mpm {

constexpr int block_edge = 4;
constexpr int arena_edge = block_edge + 2;  ///< a block's cells and the furthest nodes they touch

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }
template <int Dim>
constexpr int cells_per_block = power(block_edge, Dim);
template <int Dim>
constexpr int nodes_per_arena = power(arena_edge, Dim);

/// Node records are four wide, and a node has two: in arenas (mass, momentum) and (filling, impulse of the
/// step's forces), in nodes (mass, new velocity) and (filling, new velocity - keep * old velocity). Filling
/// is the particles' volume per volume of the node: 1 where they neither overlap nor gape.
constexpr int record = 4;
constexpr int node_values = 2 * record;

/// What is averaged through the nodes, a value a node each; dilatation is that of the last step.
enum class Average { volume, pressure, dilatation };
constexpr int average_count = 3;

/// The grid's memory. Arenas belong to the occupied blocks, nodes and averages to all that exist; averages
/// are null where nothing is averaged through the nodes, holds where no plane wall has friction.
template <class T>
struct Grid {
  T* arenas = nullptr;
  T* nodes = nullptr;
  T* averages = nullptr;
  T* holds = nullptr;  ///< a value a node: how far a plane wall of friction held it in this step, 0 to 1
};

/// One average of a block of nodes.
template <int Dim, class T>
T* averages_of(T* averages, std::uint32_t slot, Average which) {
  return averages + (static_cast<std::size_t>(slot) * average_count + static_cast<std::size_t>(which)) *
                        cells_per_block<Dim>;
}

/// A plane wall on a face of the background grid. One of friction holds what presses it as one of no slip
/// does, up to its limit (plane_friction.h).
enum class PlaneWall : std::uint8_t { none, slip, no_slip, friction };

/// Bounds along one axis in cells: material lies in [lower_cell, upper_cell). Ignored where the wall is
/// `none`.
struct AxisBounds {
  PlaneWall lower = PlaneWall::none, upper = PlaneWall::none;
  int lower_cell = 0, upper_cell = 0;
  bool periodic = false;  ///< [lower_cell, upper_cell) wraps; a multiple of block_edge long
  double lower_friction = 0.0, upper_friction = 0.0;  ///< Coulomb's coefficients, of PlaneWall::friction
};

using CellIndex = std::array<std::int32_t, 3>;  ///< global cell coordinates; the third is 0 in two dimensions

/// A particle that left its cell in this step: by one cell at most along each axis.
struct Mover {
  std::uint32_t index;  ///< in its block
  std::int8_t shift[3];
  std::uint8_t cell;  ///< of the block, where it was
};

/// Sums and extremes of one block over one step, merged in block order so that results do not depend on
/// threads.
struct BlockSums {
  double largest_speed_squared = 0.0;  ///< m2/s2
  double largest_pressure = 0.0;       ///< Pa
  double dissipated = 0.0;             ///< J
  double momentum = 0.0;               ///< kg m/s along the first axis, of the motion itself
  std::uint32_t movers = 0;
  std::uint32_t faults = 0;  ///< particles that moved further than a cell or are not finite
};

/// A set of walls of any shape, a bit for each.
using WallSet = std::uint64_t;
/// How far a particle may go in a step, in cells, for the walls near its cell to be all that it can get into.
constexpr double wall_reach = 0.25;

/// What a kernel sees of one occupied block.
struct BlockView {
  int origin[3] = {0, 0, 0};  ///< first cell, in cells
  std::uint32_t slot = 0;     ///< its place in the array of nodes
  std::uint32_t arena = 0;    ///< and in that of arenas, which only blocks with particles have
  std::uint32_t first = 0;    ///< of its particles in their arrays, where they lie sorted by cell
  const std::uint32_t* start =
      nullptr;  ///< of each cell's particles, from `first`; cells_per_block + 1 of them
  const WallSet* walls =
      nullptr;  ///< of any shape, that each cell's particles may get into; null where there are none near
  const std::uint32_t* plus =
      nullptr;              ///< slots of the 2^Dim blocks at +{0,1} per axis; no_slot where absent
  Mover* movers = nullptr;  ///< room for every particle of the block
  BlockSums* sums = nullptr;
};
constexpr std::uint32_t no_slot = 0xffffffffu;

/// What a kernel sees of one block of nodes: the arenas that hold parts of it.
struct NodeView {
  std::uint32_t slot = 0;
  const std::uint32_t* minus =
      nullptr;  ///< arenas of the occupied blocks at -{0,1} per axis; no_slot where there is none
};

/// The particles' arrays. Positions are cell-relative, in [0, 1) of the cell, so that small motions are not
/// lost in a large coordinate whatever the precision. Arrays a scene does not use are null.
template <class T>
struct ParticleView {
  T* position[3] = {};        ///< within the cell, in cells
  T* velocity[3] = {};        ///< m/s
  T* affine[9] = {};          ///< APIC: velocity difference across a cell, m/s; [i * Dim + j]
  T* deviator[5] = {};        ///< deviatoric stress, Pa
  T* volume_ratio = nullptr;  ///< J
  T* pressure = nullptr;      ///< Pa, of the equation of state
  T* mass = nullptr;          ///< kg, constant
  T* rate = nullptr;          ///< 1/s, plastic (EVP) or total (fluid) shear rate
  T* lambda = nullptr;        ///< flocculation state
  T* advection[3] = {};       ///< FLIP: the grid's velocity at the particle, m/s
};

}  // namespace flowrest::mpm
