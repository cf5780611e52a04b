#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// A mesh of blocks, known once: as blockMesh makes it, and cell by cell as gauges need it.
namespace flowrest::foam {

using Point = std::array<double, 3>;

/// Sides of a block, by axis and whether it is the lower or the upper one.
enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };

/// Blocks between neighbouring corners of a lattice that may be bent.
struct BlockLattice {
  std::array<std::vector<int>, 3> cells;       ///< along each axis, of each interval between corners
  std::function<Point(int, int, int)> corner;  ///< m
  std::function<bool(int, int, int)> holds;    ///< whether there is a block beyond this corner
  std::function<std::string(int, int, int, Side)> patch;         ///< of a side that has no neighbour
  std::vector<std::pair<std::string, std::string>> patch_types;  ///< name and type, in their order

  bool has(int i, int j, int k) const;
};

struct MeshCell {
  Point low{}, high{};  ///< m, means over the corners on either side of each axis
  double volume = 0.0;  ///< m3
  Point centre() const {
    return {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])};
  }
};

/// Cells in the order of blockMesh: block by block (the first axis fastest), and so within a block.
std::vector<MeshCell> mesh_cells(const BlockLattice&);

/// The text of blockMeshDict; `what` tells of the mesh in comment lines.
std::string block_mesh_dictionary(const BlockLattice&, const std::string& what);

}  // namespace flowrest::foam
