#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mpm/solver/solver.h"

namespace flowrest::mpm {

/// The pressure without the part that no motion feels. Averaged through the nodes (the smooth B-bar) it acts
/// smoothly, and that is it. Where pressures act as averages over cells, averages that alternate from cell to
/// cell push nodes hardly at all, so they come and go; within a cell, particles differ at will. Averaged to
/// the corners of cells (by volume) and interpolated from there, both are gone, and a field linear in space
/// stays as it is, save in the outermost half cell.
class AveragedPressure {
 public:
  AveragedPressure(int dimension, double cell) : dimension_(dimension), cell_(cell) {}
  /// Takes in particles; all of a body's, before the first `at`.
  void add(const ParticleBatch&);
  /// Pa, of each particle of the batch.
  std::vector<double> at(const ParticleBatch&) const;

 private:
  using Corner = std::array<std::int32_t, 3>;
  struct Sum {
    double volume = 0.0, thrust = 0.0;  ///< m3; J, volume times pressure
  };
  struct Hash {
    std::size_t operator()(const Corner&) const;
  };
  Corner cell_of(const ParticleBatch&, std::size_t particle) const;
  Corner corner_of(const Corner& cell, int corner) const;

  int dimension_;
  double cell_;
  std::unordered_map<Corner, Sum, Hash> corners_;
};

}  // namespace flowrest::mpm
