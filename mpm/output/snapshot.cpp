#include "mpm/output/snapshot.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "mpm/output/averaged_pressure.h"
#include "mpm/output/hdf5_file.h"
#include "mpm/solver/settings.h"
#include "runs/folder.h"
#include "runs/run_directory.h"

namespace flowrest::mpm {

namespace {

constexpr std::uint8_t vtk_vertex = 1;

void append(std::vector<float>& to, const std::vector<double>& from) {
  for (const double v : from) to.push_back(static_cast<float>(v));
}

}  // namespace

SnapshotWriter::SnapshotWriter(const std::filesystem::path& directory, const scenes::Scene& scene,
                               double resume_time)
    : directory_(directory),
      cell_(cell_size(scene)),
      duct_(scene.kind == scenes::Kind::duct),
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
  std::vector<float> points, velocity, rate, stress, pressure, raw_pressure, volume, flocculation;
  AveragedPressure averaged(dimension_, cell_);
  solver.visit([&](const ParticleBatch& batch) { averaged.add(batch); });
  solver.visit([&](const ParticleBatch& batch) {
    for (std::size_t i = 0; i < batch.count; ++i)
      for (auto [to, from] : {std::pair{&points, &batch.position}, std::pair{&velocity, &batch.velocity}}) {
        const auto at = [&](std::size_t axis) { return static_cast<float>((*from)[axis][i]); };
        // A slump's section stands upright, so that it can be laid over a three-dimensional run.
        const bool upright = dimension_ == 2 && !duct_;
        to->insert(to->end(), {at(0), upright ? 0.0f : at(1), upright ? at(1) : at(2)});
      }
    append(rate, batch.rate);
    append(stress, batch.shear_stress);
    append(pressure, averaged.at(batch));
    append(raw_pressure, batch.raw_pressure);
    append(volume, batch.volume);
    append(flocculation, batch.flocculation);
  });
  const auto count = static_cast<std::int64_t>(rate.size());
  std::vector<std::int64_t> connectivity(rate.size()), offsets(rate.size() + 1);
  std::iota(connectivity.begin(), connectivity.end(), 0);
  std::iota(offsets.begin(), offsets.end(), 0);
  const std::vector<std::uint8_t> types(rate.size(), vtk_vertex);

  runs::make_folder(directory_);
  const std::string name = name_of(series_.size());
  Hdf5File file = Hdf5File::create(directory_ / name);
  file.group("/VTKHDF");
  file.attribute("/VTKHDF", "Version", std::array<std::int64_t, 2>{1, 0});
  file.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
  for (const char* size : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    file.write(fmt::format("/VTKHDF/{}", size), std::span(&count, 1));
  file.write("/VTKHDF/Points", points, 3);
  file.write("/VTKHDF/Connectivity", connectivity);
  file.write("/VTKHDF/Offsets", offsets);
  file.write("/VTKHDF/Types", types);
  file.group("/VTKHDF/PointData");
  file.write("/VTKHDF/PointData/velocity", velocity, 3);
  file.write("/VTKHDF/PointData/shear_rate", rate);
  file.write("/VTKHDF/PointData/shear_stress", stress);
  file.write("/VTKHDF/PointData/pressure", pressure);
  file.write("/VTKHDF/PointData/raw_pressure", raw_pressure);
  file.write("/VTKHDF/PointData/volume", volume);
  if (!flocculation.empty()) file.write("/VTKHDF/PointData/flocculation", flocculation);
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
