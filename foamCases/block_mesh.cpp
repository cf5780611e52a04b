#include "foamCases/block_mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace flowrest::foam {

namespace {

using Index = std::array<int, 3>;

/// The eight corners of a hexahedron as blockMesh numbers them.
constexpr std::array<Index, 8> hexahedron{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// Its faces, in the order of Side.
constexpr std::array<std::array<std::size_t, 4>, 6> faces{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};

constexpr std::array<Index, 6> towards{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

template <class Visit>
void for_each_block(const BlockLattice& lattice, Visit visit) {
  const auto count = [&](std::size_t axis) { return static_cast<int>(lattice.cells[axis].size()); };
  for (int k = 0; k < count(2); ++k)
    for (int j = 0; j < count(1); ++j)
      for (int i = 0; i < count(0); ++i)
        if (lattice.has(i, j, k)) visit(i, j, k);
}

Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }

/// A block's corners and what lies between them, linearly along each axis.
class Hexahedron {
 public:
  Hexahedron(const BlockLattice& lattice, int i, int j, int k) {
    for (std::size_t n = 0; n < 8; ++n)
      corner_[n] = lattice.corner(i + hexahedron[n][0], j + hexahedron[n][1], k + hexahedron[n][2]);
  }
  Point at(double u, double v, double w) const {
    Point p{};
    for (std::size_t n = 0; n < 8; ++n) {
      const auto& c = hexahedron[n];
      p = p + (c[0] ? u : 1.0 - u) * (c[1] ? v : 1.0 - v) * (c[2] ? w : 1.0 - w) * corner_[n];
    }
    return p;
  }

 private:
  std::array<Point, 8> corner_;
};

/// The volume between eight corners: Gauss' rule with two points to an axis is exact for its Jacobian.
double volume_of(const std::array<Point, 8>& corner) {
  const double near = 0.5 - 0.5 / std::sqrt(3.0);
  double volume = 0.0;
  for (const double u : {near, 1.0 - near})
    for (const double v : {near, 1.0 - near})
      for (const double w : {near, 1.0 - near}) {
        std::array<Point, 3> edge{};
        for (std::size_t n = 0; n < 8; ++n) {
          const auto& c = hexahedron[n];
          const double a = c[0] ? u : 1.0 - u, b = c[1] ? v : 1.0 - v, d = c[2] ? w : 1.0 - w;
          edge[0] = edge[0] + (c[0] ? 1.0 : -1.0) * b * d * corner[n];
          edge[1] = edge[1] + (c[1] ? 1.0 : -1.0) * a * d * corner[n];
          edge[2] = edge[2] + (c[2] ? 1.0 : -1.0) * a * b * corner[n];
        }
        const auto& [p, q, r] = edge;
        volume += 0.125 * (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
                           p[2] * (q[0] * r[1] - q[1] * r[0]));
      }
  return volume;
}

MeshCell cell_of(const std::array<Point, 8>& corner) {
  MeshCell cell;
  for (std::size_t n = 0; n < 8; ++n)
    for (std::size_t axis = 0; axis < 3; ++axis)
      (hexahedron[n][axis] ? cell.high : cell.low)[axis] += 0.25 * corner[n][axis];
  cell.volume = volume_of(corner);
  return cell;
}

}  // namespace

bool BlockLattice::has(int i, int j, int k) const {
  const Index index{i, j, k};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (index[axis] < 0 || index[axis] >= static_cast<int>(cells[axis].size())) return false;
  return holds(i, j, k);
}

std::vector<MeshCell> mesh_cells(const BlockLattice& lattice) {
  std::vector<MeshCell> all;
  for_each_block(lattice, [&](int i, int j, int k) {
    const Hexahedron block(lattice, i, j, k);
    const Index count{lattice.cells[0][static_cast<std::size_t>(i)],
                      lattice.cells[1][static_cast<std::size_t>(j)],
                      lattice.cells[2][static_cast<std::size_t>(k)]};
    for (int c = 0; c < count[2]; ++c)
      for (int b = 0; b < count[1]; ++b)
        for (int a = 0; a < count[0]; ++a) {
          std::array<Point, 8> corner;
          for (std::size_t n = 0; n < 8; ++n)
            corner[n] = block.at(static_cast<double>(a + hexahedron[n][0]) / count[0],
                                 static_cast<double>(b + hexahedron[n][1]) / count[1],
                                 static_cast<double>(c + hexahedron[n][2]) / count[2]);
          all.push_back(cell_of(corner));
        }
  });
  return all;
}

std::string block_mesh_dictionary(const BlockLattice& lattice, const std::string& what) {
  std::map<Index, int> number;
  std::string vertices, blocks;
  std::map<std::string, std::string> patch_faces;
  for_each_block(lattice, [&](int i, int j, int k) {
    std::array<int, 8> corner{};
    for (std::size_t n = 0; n < 8; ++n) {
      const Index at{i + hexahedron[n][0], j + hexahedron[n][1], k + hexahedron[n][2]};
      const auto [found, fresh] = number.emplace(at, static_cast<int>(number.size()));
      corner[n] = found->second;
      if (!fresh) continue;
      const Point p = lattice.corner(at[0], at[1], at[2]);
      vertices += fmt::format("    ({} {} {})\n", p[0], p[1], p[2]);
    }
    blocks += fmt::format("    hex ({}) ({} {} {}) simpleGrading (1 1 1)\n", fmt::join(corner, " "),
                          lattice.cells[0][static_cast<std::size_t>(i)],
                          lattice.cells[1][static_cast<std::size_t>(j)],
                          lattice.cells[2][static_cast<std::size_t>(k)]);
    for (std::size_t side = 0; side < 6; ++side) {
      const auto& to = towards[side];
      if (lattice.has(i + to[0], j + to[1], k + to[2])) continue;
      const auto& face = faces[side];
      patch_faces[lattice.patch(i, j, k, static_cast<Side>(side))] +=
          fmt::format(" ({} {} {} {})", corner[face[0]], corner[face[1]], corner[face[2]], corner[face[3]]);
    }
  });
  std::string patches;
  for (const auto& [name, type] : lattice.patch_types)
    if (const auto found = patch_faces.find(name); found != patch_faces.end())
      patches += fmt::format("    {} {{ type {}; faces ({} ); }}\n", name, type, found->second);
  return fmt::format(
      "{}\nFoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       dictionary;\n    "
      "object      "
      "blockMeshDict;\n}}\n\nconvertToMeters 1;\n\nvertices\n(\n{});\n\nblocks\n(\n{});\n\nedges "
      "();\n\nboundary\n(\n{"
      "});\n\nmergePatchPairs ();\n",
      what, vertices, blocks, patches);
}

}  // namespace flowrest::foam
