#include "mpm/output/snapshot.h"

#include <hdf5.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mpm/output/test_runs.h"
#include "mpm/sampling/sampling.h"
#include "mpm/solver/settings.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;
using testing::ElementsAre;
namespace fs = std::filesystem;

namespace {

/// An HDF5 file read with the library's own calls, so that our writer is not its own judge.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ~Reader() { H5Fclose(file_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  std::vector<hsize_t> shape(const std::string& path) const {
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    if (set < 0) return {};
    const hid_t space = H5Dget_space(set);
    std::vector<hsize_t> size(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, size.data(), nullptr);
    H5Sclose(space);
    H5Dclose(set);
    return size;
  }
  std::vector<double> values(const std::string& path) const {
    std::size_t count = 1;
    for (const auto n : shape(path)) count *= n;
    std::vector<double> out(count);
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
    H5Dclose(set);
    return out;
  }
  bool stored_as(const std::string& path, hid_t type) const {
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT), stored = H5Dget_type(set);
    const bool same = H5Tequal(stored, type) > 0;
    H5Tclose(stored);
    H5Dclose(set);
    return same;
  }
  std::vector<std::int64_t> version() const {
    const hid_t attribute = H5Aopen_by_name(file_, "/VTKHDF", "Version", H5P_DEFAULT, H5P_DEFAULT);
    std::vector<std::int64_t> out(2);
    H5Aread(attribute, H5T_NATIVE_INT64, out.data());
    H5Aclose(attribute);
    return out;
  }
  /// The text, and whether it is of fixed length: VTK reads no other.
  std::pair<std::string, bool> type() const {
    const hid_t attribute = H5Aopen_by_name(file_, "/VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    const bool fixed = H5Tis_variable_str(type) == 0;
    std::string text(H5Tget_size(type), '\0');
    H5Aread(attribute, type, text.data());
    H5Tclose(type);
    H5Aclose(attribute);
    return {text, fixed};
  }

 private:
  hid_t file_;
};

}  // namespace

class Snapshot : public RunTest {};

TEST_F(Snapshot, IsAVtkHdfUnstructuredGridOfVertices) {
  const auto scene = tiny_slump();
  const auto seeds = seed_particles(scene);
  auto solver = make_solver(settings_of(scene), seeds);
  SnapshotWriter(folder, scene, -1.0).write(0.25, *solver);
  const Reader file(folder / "particles_000000.hdf");
  const hsize_t n = seeds.size();
  EXPECT_THAT(file.version(), ElementsAre(1, 0));
  EXPECT_EQ(file.type(), std::pair(std::string("UnstructuredGrid"), true));
  EXPECT_THAT(file.shape("/VTKHDF/Points"), ElementsAre(n, 3));
  EXPECT_TRUE(file.stored_as("/VTKHDF/Points", H5T_IEEE_F32LE));
  for (const char* count : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"}) {
    EXPECT_THAT(file.values(std::string("/VTKHDF/") + count), ElementsAre(static_cast<double>(n))) << count;
    EXPECT_TRUE(file.stored_as(std::string("/VTKHDF/") + count, H5T_STD_I64LE)) << count;
  }
  EXPECT_TRUE(file.stored_as("/VTKHDF/Types", H5T_STD_U8LE));
  const auto connectivity = file.values("/VTKHDF/Connectivity"), offsets = file.values("/VTKHDF/Offsets");
  ASSERT_EQ(connectivity.size(), n);
  ASSERT_EQ(offsets.size(), n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(connectivity[i], static_cast<double>(i));
    ASSERT_EQ(offsets[i], static_cast<double>(i));
  }
  EXPECT_EQ(offsets.back(), static_cast<double>(n));
  for (const double type : file.values("/VTKHDF/Types")) ASSERT_EQ(type, 1.0);
  EXPECT_THAT(file.shape("/VTKHDF/PointData/velocity"), ElementsAre(n, 3));
  for (const char* name : {"shear_rate", "shear_stress", "pressure", "raw_pressure", "volume"})
    EXPECT_THAT(file.shape(std::string("/VTKHDF/PointData/") + name), ElementsAre(n)) << name;
  EXPECT_THAT(file.shape("/VTKHDF/PointData/flocculation"), ElementsAre())
      << "a scene without thixotropy has none";
  double volume = 0.0;
  for (const double v : file.values("/VTKHDF/PointData/volume")) volume += v;
  EXPECT_NEAR(volume, 5.497787e-3, 1e-8);
  // The section stands upright: heights are along z, and nothing lies off the plane.
  const auto points = file.values("/VTKHDF/Points");
  double highest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(points[3 * i + 1], 0.0);
    highest = std::max(highest, points[3 * i + 2]);
  }
  EXPECT_NEAR(highest, 0.3, 0.02);
}

TEST_F(Snapshot, HoldsTheWholeStressOfEveryParticle) {
  for (const char* dimension : {"axisymmetric", "quarter"}) {
    const auto scene =
        tiny_slump({std::string("geometry.dimension=") + dimension, "mpm.cell=0.025",
                    "mpm.particles_per_cell=[2" + std::string(dimension[0] == 'q' ? ",2" : "") + ",2]"});
    auto solver = make_solver(settings_of(scene), seed_particles(scene));
    for (int i = 0; i < 30; ++i) solver->step(5e-4, acceleration_at(scene, 0.0));
    const fs::path place = folder / dimension;
    SnapshotWriter(place, scene, -1.0).write(0.015, *solver);
    const Reader file(place / "particles_000000.hdf");
    const auto stress = file.values("/VTKHDF/PointData/stress"),
               invariant = file.values("/VTKHDF/PointData/shear_stress");
    ASSERT_EQ(stress.size(), 6 * invariant.size());
    double largest = 0.0;
    for (std::size_t p = 0; p < invariant.size(); ++p) {
      const double* const s = &stress[6 * p];
      ASSERT_NEAR(s[0] + s[1] + s[2], 0.0, 1e-4) << "a deviator has no trace";
      const double half =
          0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) + s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
      ASSERT_NEAR(std::sqrt(half), invariant[p], 1e-4 * (1.0 + invariant[p]));
      largest = std::max(largest, invariant[p]);
    }
    EXPECT_GT(largest, 40.0) << "it is under load";
  }
}

TEST_F(Snapshot, ThixotropicParticlesCarryTheirFlocculation) {
  const auto scene =
      tiny_slump({"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                  "thixotropy.initial_flocculation=1.8"});
  auto solver = make_solver(settings_of(scene), seed_particles(scene));
  SnapshotWriter(folder, scene, -1.0).write(0.0, *solver);
  for (const double lambda : Reader(folder / "particles_000000.hdf").values("/VTKHDF/PointData/flocculation"))
    ASSERT_FLOAT_EQ(static_cast<float>(lambda), 1.8f);
}

TEST_F(Snapshot, TheSeriesListsEverySnapshotWithItsTime) {
  run(tiny_slump(), options("run"));
  const auto series = nlohmann::json::parse(text_of(folder / "run" / "particles" / "particles.hdf.series"));
  ASSERT_EQ(series["files"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(series["files"][i]["time"].get<double>(), 0.1 * static_cast<double>(i), 1e-12);
    EXPECT_TRUE(std::filesystem::exists(folder / "run" / "particles" /
                                        series["files"][i]["name"].get<std::string>()));
  }
}

TEST_F(Snapshot, SnapshotsAfterTheTimeOfResumptionLeaveTheSeries) {
  const auto scene = tiny_slump();
  auto solver = make_solver(settings_of(scene), seed_particles(scene));
  SnapshotWriter first(folder, scene, -1.0);
  for (const double time : {0.0, 0.1, 0.2}) first.write(time, *solver);
  SnapshotWriter(folder, scene, 0.15).write(0.3, *solver);
  const auto series = nlohmann::json::parse(text_of(folder / "particles.hdf.series"));
  ASSERT_EQ(series["files"].size(), 3u);
  EXPECT_EQ(series["files"][2]["time"], 0.3);
  EXPECT_EQ(series["files"][2]["name"], "particles_000002.hdf");
}
