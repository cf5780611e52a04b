#pragma once

#include <array>
#include <string>
#include <vector>

#include "foamCases/apparatus/apparatus.h"
#include "foamCases/block_mesh.h"

/// Vessels that concrete flows out of or along. x runs along the channel or across the funnel's slopes, z
/// upwards.
namespace flowrest::foam {

/// A vessel whose mesh is a lattice of blocks with cells of about foam.cell, and whose concrete fills a box
/// of it at the start.
class Vessel : public ApparatusCase {
 public:
  using ApparatusCase::ApparatusCase;

  /// The blocks of its mesh.
  /// @throws scenes::SceneError where it cannot be laid out, saying what is allowed.
  BlockLattice mesh() const;
  /// The box that the concrete fills at the start: two corners, m. Faces of cells lie on its sides.
  virtual std::array<Point, 2> initial_box() const = 0;

  void check() const override { mesh(); }
  std::size_t cells() const override { return mesh_cells(mesh()).size(); }
  std::size_t slices() const override { return slices_along(0); }
  bool rates_follow_from_velocities() const override { return false; }
  std::string mesh_parameters() const override;
  std::vector<CaseFile> files() const override;
  std::vector<Utility> utilities() const override { return {{"setFields"}}; }
  std::unique_ptr<Sampler> sampler(CaseFields, runs::RunWriter&, bool plug_in) const override;

 protected:
  virtual BlockLattice lattice() const = 0;
  void check_dimension(scenes::Dimension allowed) const;
  /// Different places of cells along an axis, to a micrometre.
  std::size_t slices_along(std::size_t axis) const;
};

/// Beyond which there is nothing of a vessel, m.
inline constexpr double far = 1e3;
/// As of the material point method's front wall, m.
inline constexpr double wall_thickness = 0.04;

int cells_over(double length, double cell);
/// As cells_over, of a length that may be of any size.
double estimated_over(double length, double cell);

/// Places along an axis between which cells are laid.
struct Line {
  std::vector<double> at;
  std::vector<int> cells;
};

/// Places that are one lie no further apart, m.
inline constexpr double same_place = 1e-9;

/// Lines through the given places, sorted and each once, with cells of about `cell` between them.
Line line_through(std::vector<double> places, double cell);

/// Whole body over what the mesh holds: the missing parts, or a metre of a plane.
double whole_over_mesh(const scenes::Scene&);

}  // namespace flowrest::foam
