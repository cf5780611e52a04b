#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace flowrest::mpm {

/// The body whose mesh is wanted: an outline in the plane of the first axis and the vertical one, in the
/// order of its corners; in space either turned about the vertical axis or stretched along the second axis.
struct MeshedBody {
  std::vector<std::array<double, 2>> outline;  ///< m
  int dimension = 2;
  double turn = 0.0;                ///< rad; 0: stretched
  double lower = 0.0, upper = 0.0;  ///< m, of the stretch
};

/// A triangle or tetrahedron of a mesh.
struct MeshElement {
  std::array<double, 3> centroid{};        ///< m; in the plane the third is not used
  double size = 0.0;                       ///< m2 or m3
  std::array<double, 3> lower{}, upper{};  ///< m, of its corners
};

/// Meshes a body with elements of `size` (m2 or m3) on average, by the program gmsh.
/// @throws runs::MissingProgram where gmsh is not installed, runs::RunError where it fails or its mesh does
/// not fill the body with elements of that size.
std::vector<MeshElement> mesh_by_gmsh(const MeshedBody&, double size);

/// Why elements asked for with `size` (m2 or m3) do not fill the body: their volume, their bounds or their
/// number are not as they must be; empty where they do.
std::string misfit(const MeshedBody&, const std::vector<MeshElement>&, double size);

/// The triangles (dimension 2) or tetrahedra (3) of a mesh in Gmsh's format 2.2, ASCII.
/// @throws runs::RunError where the file is no such mesh.
std::vector<MeshElement> read_gmsh(const std::filesystem::path& file, int dimension);

}  // namespace flowrest::mpm
