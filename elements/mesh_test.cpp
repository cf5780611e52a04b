#include "elements/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elements/column_system.h"
#include "elements/test_problems.h"

using namespace flowrest::elements;
using namespace flowrest::elements::test;

namespace {

const Topology topology{24, 4};

/// Volume of all elements, of a radian; 0 where one is folded.
double volume_of(const Mesh& mesh) {
  double sum = 0.0;
  for (int c = 0; c < mesh.topology.columns; ++c)
    for (int r = 0; r < mesh.topology.rows; ++r) {
      ElementMatrices e;
      if (!e.compute(mesh.element(c, r), Symmetry::about_axis)) return 0.0;
      sum += e.weight.sum();
    }
  return sum;
}

}  // namespace

TEST(Mesh, FillsACone) {
  const Surface cone = Surface::of_cone(roussel(), 1400);
  // The edge of the cone's top lies within a side of an element, which rounds it.
  EXPECT_NEAR(
      2.0 * std::numbers::pi * volume_of(make_mesh(topology, cone)) / cone.volume(Symmetry::about_axis), 1.0,
      2e-3);
}

TEST(Mesh, IsSoundUnderAFrontThatTouchesDown) {
  // A nose of half a circle: at the toe the surface leaves the floor at half a turn.
  std::vector<Point> line;
  for (int i = 0; i <= 200; ++i) line.push_back({0.2 * i / 200.0, 0.04});
  for (int i = 1; i <= 200; ++i) {
    const double angle = std::numbers::pi * i / 200.0;
    line.push_back({0.2 + 0.02 * std::sin(angle), 0.02 + 0.02 * std::cos(angle)});
  }
  line.back().y() = 0.0;
  const Surface nose(line);
  EXPECT_NEAR(
      2.0 * std::numbers::pi * volume_of(make_mesh(topology, nose)) / nose.volume(Symmetry::about_axis), 1.0,
      1e-3);
}

TEST(Mesh, CarriesALinearFieldOverExactly) {
  const Mesh from = make_mesh(topology, Surface::of_cone(roussel(), 1400));
  Mesh to = from;
  to.position *= 0.9;
  const auto field = [](const Mesh& mesh) {
    Field values(2, mesh.position.cols());
    values.row(0) = 2.0 * mesh.position.row(0) - mesh.position.row(1);
    values.row(1) = mesh.position.row(0) + 3.0 * mesh.position.row(1);
    return values;
  };
  const auto carried = transfer(from, {field(from)}, to);
  EXPECT_LT((carried[0] - field(to)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Mesh, FindsAPointInTheFanAtTheToe) {
  const Mesh mesh = make_mesh(topology, Surface::of_cone(roussel(), 1400));
  const Point point = mesh.element(23, 2) * shape_at(0.4, -0.2).value;
  const Place place = locate(mesh, point, {20, 0, 0.0, 0.0});
  EXPECT_EQ(place.column, 23);
  EXPECT_EQ(place.row, 2);
  EXPECT_NEAR(place.xi, 0.4, 1e-6);
  EXPECT_NEAR(place.eta, -0.2, 1e-6);
}

TEST(ColumnSystem, SolvesWhatADenseFactorSolves) {
  const Topology small{4, 2};
  ColumnSystem system(small);
  const int unknowns = 2 * small.nodes();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(unknowns, unknowns);
  const auto column_matrix = [&](int c) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(system.order(c), system.order(c));
    for (int r = 0; r < small.rows; ++r) {
      const Eigen::MatrixXd root = Eigen::MatrixXd::Random(element_dofs, element_dofs);
      const Eigen::MatrixXd element =
          root.transpose() * root + Eigen::MatrixXd::Identity(element_dofs, element_dofs);
      for (int i = 0; i < element_dofs; ++i)
        for (int j = 0; j < element_dofs; ++j) {
          whole(2 * small.element_node(c, r, i / 2) + i % 2, 2 * small.element_node(c, r, j / 2) + j % 2) +=
              element(i, j);
          if (system.place(c, r, j) <= system.place(c, r, i))
            matrix(system.place(c, r, i), system.place(c, r, j)) += element(i, j);
        }
    }
    return matrix;
  };
  ASSERT_TRUE(system.factor(column_matrix));
  const Eigen::VectorXd right = Eigen::VectorXd::Random(unknowns);
  Eigen::VectorXd x = right;
  system.solve(x);
  EXPECT_LT((whole * x - right).norm(), 1e-10 * right.norm());
}

TEST(ColumnSystem, SaysThatAMatrixIsNotPositiveDefinite) {
  const Topology small{4, 2};
  ColumnSystem system(small);
  EXPECT_FALSE(system.factor(
      [&](int c) { return Eigen::MatrixXd(-Eigen::MatrixXd::Identity(system.order(c), system.order(c))); }));
}
