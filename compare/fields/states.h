#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"

/// The states that runs recorded, on a vertical section: particles from VTKHDF snapshots, cells from OpenFOAM
/// cases.
namespace flowrest::compare::fields {

/// Where a body is cut: upright along its plane of symmetry, or level at a height.
struct Cut {
  std::optional<double> height = {};  ///< m; empty: upright
};

/// Points or cells of a section at one time; z is a height, or the distance across where the cut is level;
/// lists of equal length, values by the quantity's name.
struct State {
  double time = 0.0;                                  ///< s
  std::vector<double> x, z;                           ///< m, of the particles or of the cells' centres
  std::vector<double> cover;                          ///< fraction of concrete; empty for particles
  std::map<std::string, std::vector<double>> values;  ///< "shear rate" 1/s, "pressure" Pa, "flocculation"
};

/// Edges of the cells of a section, m.
struct Cells {
  std::vector<double> west, east, bottom, top;
  std::size_t size() const { return west.size(); }
};

/// The states of one run, read when they are asked for.
class Recording {
 public:
  virtual ~Recording() = default;
  const std::vector<double>& times() const { return times_; }  ///< s, ascending
  const Cells& cells() const { return cells_; }                ///< empty for particles
  double spacing() const { return spacing_; }                  ///< m, of the particles when they were seeded
  /// @throws runs::RunError where the file cannot be read.
  virtual State read(std::size_t index) = 0;

 protected:
  std::vector<double> times_;
  Cells cells_;
  double spacing_ = 0.0;
};

/// Whether the run computed a body in space, which can be cut in more than one way.
bool is_solid(const RunView&);

/// The run's recording; nothing where it left none, or where it has no such cut.
std::unique_ptr<Recording> recording_of(const RunView&, const Cut& = {});

/// sqrt(2 D:D) of cells on a grid of columns and rows, 1/s. Velocities at the faces are weighted by the
/// concrete on both sides; the base holds the velocity `no_slip` (zero) or lets it slip. `radial`: x is a
/// radius, so that u/x counts.
std::vector<double> shear_rate(const Cells&, const std::vector<double>& cover, const std::vector<double>& u,
                               const std::vector<double>& w, bool radial, bool no_slip);

}  // namespace flowrest::compare::fields
