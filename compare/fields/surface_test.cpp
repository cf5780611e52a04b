// Surfaces around particles: closed, and as large as what they hold.
#include "compare/fields/surface.h"

#include <gtest/gtest.h>
#include <vtkFeatureEdges.h>
#include <vtkMassProperties.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>

#include <cmath>
#include <numbers>

#include "runs/errors.h"
#include "runs/temporary_folder.h"

namespace flowrest::compare::fields {
namespace {

/// Half a strand on a floor: half a cylinder lying on it, 120 mm long and 40 mm wide, of which y > 0 is given.
Parcels strand() {
  Parcels p;
  p.spacing = 0.001;
  p.half = true;
  for (double x = 0.0005; x < 0.12; x += p.spacing)
    for (double y = 0.0005; y < 0.02; y += p.spacing)
      for (double z = 0.0005; z < 0.02; z += p.spacing) {
        if (std::hypot(y, z) > 0.02) continue;
        p.x.push_back(x);
        p.y.push_back(y);
        p.z.push_back(z);
        p.volume.push_back(p.spacing * p.spacing * p.spacing);
      }
  return p;
}

}  // namespace

TEST(Surface, OfAStrandIsClosedAndAsLargeAsItsParticles) {
  const runs::TemporaryFolder folder;
  const auto file = folder.path() / "strand.stl";
  const Parcels parcels = strand();
  const double volume = write_surface(parcels, file);
  double held = 0.0;
  for (const double v : parcels.volume) held += 2.0 * v;
  EXPECT_NEAR(volume, held, 0.03 * held);
  EXPECT_NEAR(volume, 0.5 * std::numbers::pi * 0.02 * 0.02 * 0.12, 0.03 * held);
  // As others read it: every edge has two triangles, and the floor is plane.
  vtkNew<vtkSTLReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputConnection(reader->GetOutputPort());
  edges->BoundaryEdgesOn();
  edges->NonManifoldEdgesOn();
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->Update();
  EXPECT_GT(reader->GetOutput()->GetNumberOfPolys(), 1000);
  EXPECT_EQ(edges->GetOutput()->GetNumberOfCells(), 0);
  double bounds[6];
  reader->GetOutput()->GetBounds(bounds);
  EXPECT_NEAR(bounds[4], 0.0, 1e-4);
  EXPECT_NEAR(bounds[5], 0.02, 1e-3);
  EXPECT_NEAR(bounds[2], -bounds[3], 1e-7);
}

TEST(Surface, OfNothingIsRefused) {
  const runs::TemporaryFolder folder;
  EXPECT_THROW(write_surface({}, folder.path() / "nothing.stl"), runs::RunError);
}

}  // namespace flowrest::compare::fields
