#pragma once

#include <filesystem>

#include "mpm/solver/solver.h"
#include "scenes/scene.h"

namespace flowrest::mpm {

/// Writes the particles as VTKHDF 1.0 UnstructuredGrid, `particles_NNNNNN.hdf`, and brings
/// `particles.hdf.series`, which ParaView opens as a time series, up to date. Points (m) carry velocity
/// (m/s), shear_rate (1/s), shear_stress, pressure (averaged, see AveragedPressure) and raw_pressure (Pa),
/// stress (Pa, the deviator: XX, YY, ZZ, XY, YZ, XZ), volume (m3) and, where thixotropic, flocculation.
/// Axisymmetric and plane sections lie in x-z.
class SnapshotWriter {
 public:
  /// `directory` is made if it is missing; snapshots after `resume_time` are removed.
  SnapshotWriter(const std::filesystem::path& directory, const scenes::Scene&, double resume_time);
  /// Each time once: a second snapshot of the same time is left out.
  void write(double time, Solver&);

 private:
  static std::string name_of(std::size_t number);
  void write_series() const;

  std::filesystem::path directory_;
  double cell_ = 0.0;
  bool upright_ = false;
  int dimension_ = 2;
  std::vector<std::pair<std::string, double>> series_;
};

}  // namespace flowrest::mpm
