// The fields of the finite elements as VTK reads them, which ParaView reads them with.
#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <fstream>

#include "elements/fields.h"
#include "elements/test_problems.h"
#include "runs/temporary_folder.h"

using namespace flowrest;

TEST(Fields, AreWhatVtkReads) {
  elements::Slump slump(elements::test::roussel(), elements::test::coarse(12, 3));
  elements::test::advance(slump, 0.05);
  const runs::TemporaryFolder folder;
  elements::FieldWriter(folder.path()).write(slump);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "fields_000000.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  const auto& mesh = slump.mesh();
  ASSERT_EQ(grid->GetNumberOfPoints(), mesh.topology.nodes());
  ASSERT_EQ(grid->GetNumberOfCells(), mesh.topology.elements());
  // The first node of the second element of the first column stands over that of the first: the cells are in
  // order.
  EXPECT_EQ(grid->GetCell(1)->GetPointId(0), mesh.topology.element_node(0, 1, 0));
  EXPECT_EQ(grid->GetCell(0)->GetPointId(8), mesh.topology.element_node(0, 0, 4));
  vtkDataArray *velocity = grid->GetPointData()->GetArray("velocity"),
               *pressure = grid->GetPointData()->GetArray("pressure"),
               *rate = grid->GetPointData()->GetArray("shear_rate");
  ASSERT_TRUE(velocity && pressure && rate);
  const int top = mesh.topology.surface_node(0);
  EXPECT_NEAR(grid->GetPoint(top)[2], mesh.position(1, top), 1e-7);
  EXPECT_NEAR(velocity->GetComponent(top, 2), slump.velocity()(1, top), 1e-6);
  EXPECT_LT(velocity->GetComponent(top, 2), -0.1) << "the middle falls";
  EXPECT_GT(pressure->GetComponent(0, 0), 1000.0) << "and presses on the floor";
  for (int i = 0; i < mesh.topology.nodes(); ++i) EXPECT_GE(rate->GetComponent(i, 0), 0.0);
}
