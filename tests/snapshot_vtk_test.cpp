// A particle snapshot as VTK, and with it ParaView, reads it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkHDFReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "mpm/output/averaged_pressure.h"
#include "mpm/output/snapshot.h"
#include "mpm/sampling/sampling.h"
#include "mpm/solver/settings.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
namespace fs = std::filesystem;

namespace {

/// A thixotropic slump after a few steps, and the file its snapshot is in.
class SnapshotInVtk : public testing::TestWithParam<std::string> {
 protected:
  SnapshotInVtk() {
    const bool solid = GetParam() == "quarter" || GetParam() == "full";
    const auto scene = scenes::load_scene(
        "roussel-slump", {{"geometry.dimension=" + GetParam(), "mpm.cell=0.02", "mpm.threads=1",
                           solid ? "mpm.particles_per_cell=8" : "mpm.particles_per_cell=9",
                           "thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                           "thixotropy.initial_flocculation=1.8"},
                          {}});
    settings = mpm::settings_of(scene);
    solver = mpm::make_solver(settings, mpm::seed_particles(scene));
    for (int i = 0; i < 20; ++i) solver->step(1e-3, mpm::acceleration_at(scene, 0.0));
    mpm::SnapshotWriter(folder, scene, -1.0).write(0.02, *solver);
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
  mpm::SolverSettings settings;
  std::unique_ptr<mpm::Solver> solver;
};

}  // namespace

TEST_P(SnapshotInVtk, HoldsEveryParticleWithItsFields) {
  vtkNew<vtkHDFReader> reader;
  const std::string file = (folder / "particles_000000.hdf").string();
  ASSERT_EQ(reader->CanReadFile(file.c_str()), 1);
  reader->SetFileName(file.c_str());
  reader->Update();
  auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutput());
  ASSERT_NE(grid, nullptr);
  const auto count = static_cast<vtkIdType>(solver->particle_count());
  ASSERT_EQ(grid->GetNumberOfPoints(), count);
  ASSERT_EQ(grid->GetNumberOfCells(), count);

  const bool section = GetParam() == "axisymmetric" || GetParam() == "plane";
  vtkIdType next = 0;
  const auto field = [&](const char* name, int component = 0) {
    auto* array = grid->GetPointData()->GetArray(name);
    return array ? array->GetComponent(next, component) : std::nan("");
  };
  mpm::AveragedPressure averaged(settings.dimension, settings.cell);
  solver->visit([&](const mpm::ParticleBatch& b) { averaged.add(b); });
  solver->visit([&](const mpm::ParticleBatch& b) {
    const auto pressure = averaged.at(b);
    for (std::size_t i = 0; i < b.count; ++i, ++next) {
      ASSERT_EQ(grid->GetCellType(next), VTK_VERTEX);
      double point[3];
      grid->GetPoint(next, point);
      for (int a = 0; a < 3; ++a) {
        // A section lies in x-z: its second coordinate is the height.
        const std::size_t from = section ? (a == 2 ? 1 : a == 1 ? 2 : 0) : static_cast<std::size_t>(a);
        ASSERT_FLOAT_EQ(static_cast<float>(point[a]), static_cast<float>(b.position[from][i]));
        ASSERT_FLOAT_EQ(static_cast<float>(field("velocity", a)), static_cast<float>(b.velocity[from][i]));
      }
      ASSERT_FLOAT_EQ(static_cast<float>(field("shear_rate")), static_cast<float>(b.rate[i]));
      ASSERT_FLOAT_EQ(static_cast<float>(field("shear_stress")), static_cast<float>(b.shear_stress[i]));
      ASSERT_FLOAT_EQ(static_cast<float>(field("pressure")), static_cast<float>(pressure[i]));
      ASSERT_FLOAT_EQ(static_cast<float>(field("raw_pressure")), static_cast<float>(b.raw_pressure[i]));
      ASSERT_FLOAT_EQ(static_cast<float>(field("volume")), static_cast<float>(b.volume[i]));
      ASSERT_FLOAT_EQ(static_cast<float>(field("flocculation")), static_cast<float>(b.flocculation[i]));
    }
  });
  EXPECT_EQ(next, count);
}

INSTANTIATE_TEST_SUITE_P(OfEveryShape, SnapshotInVtk,
                         testing::Values("axisymmetric", "plane", "quarter", "full"),
                         [](const auto& tested) { return tested.param; });
