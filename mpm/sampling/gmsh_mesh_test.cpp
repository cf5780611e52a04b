#include "mpm/sampling/gmsh_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "runs/process.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::mpm;

namespace {

const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string nodes = "$Nodes\n4\n1 0 0 0\n2 2 0 0\n3 0 3 0\n7 0 0 4\n$EndNodes\n";
/// A point, a line, the triangle of nodes 1, 2 and 3, and the tetrahedron of all.
const std::string elements =
    "$Elements\n4\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n3 2 2 0 1 1 2 3\n4 4 2 0 1 1 2 3 7\n$EndElements\n";

class GmshMesh : public testing::Test {
 protected:
  ~GmshMesh() override { std::filesystem::remove(file_); }
  const std::filesystem::path& mesh(const std::string& text) {
    std::ofstream(file_) << text;
    return file_;
  }

 private:
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("flowrest-mesh-" + std::to_string(::getpid()) + ".msh");
};

double count(const std::vector<MeshElement>& mesh) { return static_cast<double>(mesh.size()); }

double volume(const std::vector<MeshElement>& mesh) {
  double sum = 0.0;
  for (const auto& e : mesh) sum += e.size;
  return sum;
}

}  // namespace

TEST_F(GmshMesh, TheReaderTakesTheElementsOfTheDimension) {
  const auto triangles = read_gmsh(mesh(head + nodes + elements), 2);
  ASSERT_EQ(triangles.size(), 1u);
  EXPECT_DOUBLE_EQ(triangles[0].size, 3.0);
  EXPECT_DOUBLE_EQ(triangles[0].centroid[0], 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(triangles[0].centroid[1], 1.0);
  const auto tetrahedra = read_gmsh(mesh(head + nodes + elements), 3);
  ASSERT_EQ(tetrahedra.size(), 1u);
  EXPECT_DOUBLE_EQ(tetrahedra[0].size, 4.0);
  EXPECT_DOUBLE_EQ(tetrahedra[0].centroid[0], 0.5);
  EXPECT_DOUBLE_EQ(tetrahedra[0].centroid[1], 0.75);
  EXPECT_DOUBLE_EQ(tetrahedra[0].centroid[2], 1.0);
}

TEST_F(GmshMesh, TheReaderRefusesWhatIsNoMesh) {
  const auto refused = [&](const std::string& text) -> std::string {
    try {
      read_gmsh(mesh(text), 3);
    } catch (const runs::RunError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused(""), testing::HasSubstr("cut short"));
  EXPECT_THAT(refused("$MeshFormat\n4.1 0 8\n"), testing::HasSubstr("another format"));
  EXPECT_THAT(refused("$MeshFormat\n2.2 1 8\n"), testing::HasSubstr("another format"));
  EXPECT_THAT(refused(head + nodes + "$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n"),
              testing::HasSubstr("unknown node 4"));
  EXPECT_THAT(refused(head + nodes + "$Elements\n1\n1 4 2 0 1 1 2 3\n$EndElements\n"),
              testing::HasSubstr("too few nodes"));
  EXPECT_THAT(refused(head + nodes + "$Elements\n2\n1 4 2 0 1 1 2 3 7\n"), testing::HasSubstr("cut short"));
}

TEST_F(GmshMesh, AMissingProgramIsNamedWithHowToGetIt) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  try {
    mesh_by_gmsh({{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}}, 0.1);
    ADD_FAILURE() << "meshed without gmsh";
  } catch (const runs::MissingProgram& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("apt-get install gmsh"));
  }
  setenv("PATH", path.c_str(), 1);
}

TEST_F(GmshMesh, ItsElementsFillTheBodyAndHaveTheAskedSize) {
  if (!runs::find_program("gmsh")) GTEST_SKIP() << "gmsh is not installed";
  const MeshedBody triangle{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
  const auto plane = mesh_by_gmsh(triangle, 1e-3);
  EXPECT_NEAR(volume(plane), 0.5, 1e-12);
  EXPECT_NEAR(static_cast<double>(plane.size()), 500.0, 50.0);

  MeshedBody prism = triangle;
  prism.dimension = 3;
  prism.lower = -0.25;
  prism.upper = 0.25;
  const auto stretched = mesh_by_gmsh(prism, 1e-4);
  EXPECT_NEAR(volume(stretched), 0.25, 1e-12);
  EXPECT_NEAR(static_cast<double>(stretched.size()), 2500.0, 500.0);
  for (const auto& e : stretched) ASSERT_LT(std::abs(e.centroid[1]), 0.25);

  MeshedBody cone = triangle;
  cone.dimension = 3;
  for (const double turn : {0.5 * std::numbers::pi, 2.0 * std::numbers::pi}) {
    cone.turn = turn;
    const double exact = turn / 6.0;
    const auto turned = mesh_by_gmsh(cone, exact / 5000.0);
    EXPECT_NEAR(volume(turned), exact, 0.01 * exact) << "straight edges cut the round side";
    EXPECT_NEAR(static_cast<double>(turned.size()), 5000.0, 1000.0);
    double least = 1.0;
    for (const auto& e : turned) {
      ASSERT_LT(std::hypot(e.centroid[0], e.centroid[1]), 1.0 - e.centroid[2]);
      least = std::min(least, e.centroid[1]);
    }
    EXPECT_EQ(least<0.0, turn> 3.0);
  }
}

/// Settings in the home and in the environment: gmsh is started without them.
TEST_F(GmshMesh, TheUsersSettingsAreNotThoseOfTheSeeding) {
  if (!runs::find_program("gmsh")) GTEST_SKIP() << "gmsh is not installed";
  const MeshedBody square{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}};
  const auto expected = mesh_by_gmsh(square, 2e-3);
  const runs::TemporaryFolder home;
  for (const char* name : {".gmshrc", ".gmsh-options"})
    std::ofstream(home / name)
        << "Mesh.RecombineAll = 1;\nMesh.MeshSizeFactor = 2;\nMesh.ElementOrder = 2;\n";
  const std::string before = std::getenv("HOME") ? std::getenv("HOME") : "/";
  setenv("HOME", home.path().c_str(), 1);
  setenv("GMSH_HOME", home.path().c_str(), 1);
  const auto mesh = mesh_by_gmsh(square, 2e-3);
  unsetenv("GMSH_HOME");
  setenv("HOME", before.c_str(), 1);
  EXPECT_EQ(mesh.size(), expected.size());
}

TEST_F(GmshMesh, ElementsThatAreNotThoseOfTheBodyAreRefused) {
  if (!runs::find_program("gmsh")) GTEST_SKIP() << "gmsh is not installed";
  MeshedBody body{{{0.0, 0.0}, {1.0, 0.0}, {0.5, 1.0}, {0.0, 1.0}}};
  for (const double turn : {0.0, 0.5 * std::numbers::pi, 2.0 * std::numbers::pi}) {
    for (const double share : {0.3, 0.03, 2e-3}) {
      body.turn = turn;
      body.dimension = turn > 0.0 ? 3 : 2;
      const auto mesh = mesh_by_gmsh(body, share);
      EXPECT_EQ(misfit(body, mesh, share), "") << turn << " " << share;
      const std::string coarse = misfit(body, mesh, 0.3 * volume(mesh) / count(mesh));
      EXPECT_NE(coarse, "");
      if (turn == 0.0) {
        EXPECT_THAT(coarse, testing::HasSubstr("on average, asked for were"));
      }
      auto moved = body;
      for (auto& corner : moved.outline) corner[1] += 1e-3;
      EXPECT_THAT(misfit(moved, mesh, share), testing::HasSubstr("it reaches from")) << turn;
      auto smaller = body;
      smaller.outline[2][0] = 0.0;
      EXPECT_THAT(misfit(smaller, mesh, share), testing::HasSubstr("it fills"));
      if (share > 0.01) continue;
      const std::vector<MeshElement> half(mesh.begin(), mesh.begin() + static_cast<long>(mesh.size() / 2));
      EXPECT_THAT(misfit(body, half, share), testing::HasSubstr("it fills"));
    }
  }
}
