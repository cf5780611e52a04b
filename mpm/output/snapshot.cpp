#include "mpm/output/snapshot.h"

#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "mpm/output/averaged_pressure.h"
#include "mpm/output/hdf5_file.h"
#include "mpm/solver/settings.h"
#include "runs/folder.h"
#include "runs/run_directory.h"
#include "scenes/pieces.h"

namespace flowrest::mpm {

namespace {

constexpr std::uint8_t vtk_vertex = 1;

void add(Hdf5Rows<float>& to, const std::vector<double>& values) {
  for (const double v : values) to.add(static_cast<float>(v));
}

/// The six components of a particle's deviator as VTK has them. A section that stands upright has its hoop
/// component, or the one normal to the plane, along y.
std::array<double, 6> symmetric_tensor(const ParticleBatch& batch, std::size_t i, int dimension,
                                       bool upright) {
  const auto at = [&](std::size_t c) { return batch.deviator[c][i]; };
  const double third = -(at(0) + at(1));
  if (dimension == 3) return {at(0), at(1), third, at(2), at(4), at(3)};
  if (upright) return {at(0), third, at(1), 0.0, 0.0, at(2)};
  return {at(0), at(1), third, at(2), 0.0, 0.0};
}

/// The cells of an unstructured grid whose points are its cells.
void write_vertices(Hdf5File& file, std::size_t count) {
  Hdf5Rows<std::int64_t> connectivity(file, "/VTKHDF/Connectivity", count);
  Hdf5Rows<std::int64_t> offsets(file, "/VTKHDF/Offsets", count + 1);
  Hdf5Rows<std::uint8_t> types(file, "/VTKHDF/Types", count);
  for (std::size_t i = 0; i < count; ++i) {
    connectivity.add(static_cast<std::int64_t>(i));
    offsets.add(static_cast<std::int64_t>(i));
    types.add(vtk_vertex);
  }
  offsets.add(static_cast<std::int64_t>(count));
  connectivity.finish();
  offsets.finish();
  types.finish();
}

}  // namespace

SnapshotWriter::SnapshotWriter(const std::filesystem::path& directory, const scenes::Scene& scene,
                               double resume_time)
    : directory_(directory),
      cell_(cell_size(scene)),
      upright_(scene.spatial_dimension() == 2 && scenes::pieces_of(scene).free_surface),
      dimension_(scene.spatial_dimension()) {
  std::ifstream file(directory_ / "particles.hdf.series");
  const auto series = nlohmann::json::parse(file, nullptr, false);
  if (series.is_discarded() || !series.contains("files")) return;
  bool dropped = false;
  for (const auto& entry : series["files"]) {
    const std::string name = entry.value("name", "");
    const double time = entry.value("time", 0.0);
    if (time <= resume_time) {
      series_.emplace_back(name, time);
    } else {
      dropped = true;
    }
  }
  if (!dropped) return;
  write_series();
  for (std::size_t number = series_.size(); std::filesystem::remove(directory_ / name_of(number));) ++number;
}

std::string SnapshotWriter::name_of(std::size_t number) { return fmt::format("particles_{:06}.hdf", number); }

void SnapshotWriter::write(double time, Solver& solver) {
  if (!series_.empty() && series_.back().second == time) return;
  AveragedPressure averaged(dimension_, cell_);
  solver.visit([&](const ParticleBatch& batch) { averaged.add(batch); });
  const std::size_t count = solver.particle_count();
  const auto count_stored = static_cast<std::int64_t>(count);

  runs::make_folder(directory_);
  const std::string name = name_of(series_.size());
  Hdf5File file = Hdf5File::create(directory_ / name);
  file.group("/VTKHDF");
  file.attribute("/VTKHDF", "Version", std::array<std::int64_t, 2>{1, 0});
  file.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
  for (const char* size : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    file.write(fmt::format("/VTKHDF/{}", size), std::span(&count_stored, 1));
  write_vertices(file, count);
  file.group("/VTKHDF/PointData");
  const auto rows = [&](const char* of, std::size_t columns = 0) {
    return std::make_unique<Hdf5Rows<float>>(file, std::string("/VTKHDF/") + of, count, columns);
  };
  const auto points = rows("Points", 3), velocity = rows("PointData/velocity", 3),
             rate = rows("PointData/shear_rate"), stress = rows("PointData/shear_stress"),
             pressure = rows("PointData/pressure"), raw_pressure = rows("PointData/raw_pressure"),
             tensor = rows("PointData/stress", 6), volume = rows("PointData/volume");
  std::unique_ptr<Hdf5Rows<float>> flocculation;
  solver.visit([&](const ParticleBatch& batch) {
    for (std::size_t i = 0; i < batch.count; ++i)
      for (auto [to, from] : {std::pair{&points, &batch.position}, std::pair{&velocity, &batch.velocity}}) {
        const auto at = [&, from = from](std::size_t axis) { return static_cast<float>((*from)[axis][i]); };
        // A section under a free surface stands upright, so that it can be laid over a run in space.
        for (const float x : {at(0), upright_ ? 0.0f : at(1), upright_ ? at(1) : at(2)}) (*to)->add(x);
      }
    add(*rate, batch.rate);
    add(*stress, batch.shear_stress);
    add(*pressure, averaged.at(batch));
    add(*raw_pressure, batch.raw_pressure);
    add(*volume, batch.volume);
    for (std::size_t i = 0; i < batch.count; ++i)
      for (const double s : symmetric_tensor(batch, i, dimension_, upright_))
        tensor->add(static_cast<float>(s));
    if (batch.flocculation.empty()) return;
    if (!flocculation) flocculation = rows("PointData/flocculation");
    add(*flocculation, batch.flocculation);
  });
  for (Hdf5Rows<float>* const written :
       {points.get(), velocity.get(), rate.get(), stress.get(), pressure.get(), raw_pressure.get(),
        tensor.get(), volume.get(), flocculation.get()})
    if (written) written->finish();
  file.commit();
  series_.emplace_back(name, time);
  write_series();
}

void SnapshotWriter::write_series() const {
  nlohmann::ordered_json series = {{"file-series-version", "1.0"}, {"files", nlohmann::json::array()}};
  for (const auto& [name, time] : series_) series["files"].push_back({{"name", name}, {"time", time}});
  runs::write_atomically(directory_ / "particles.hdf.series", series.dump(1) + "\n");
}

}  // namespace flowrest::mpm
