#include "elements/element.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace flowrest::elements;

namespace {

/// An element whose sides are curved, off the axis.
ElementPositions bent() {
  ElementPositions nodes;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double x = 0.1 + 0.05 * i, y = 0.04 * j;
      nodes.col(3 * i + j) = Point(x + 0.2 * y * y, y + 0.5 * (x - 0.1) * (x - 0.1));
    }
  return nodes;
}

Eigen::Matrix<double, element_dofs, 1> velocities(const ElementPositions& nodes,
                                                  const Eigen::Matrix2d& gradient) {
  Eigen::Matrix<double, element_dofs, 1> v;
  for (int a = 0; a < element_nodes; ++a) v.segment<2>(2 * a) = gradient * nodes.col(a);
  return v;
}

}  // namespace

TEST(Element, ShapeFunctionsSumToOneAndAreOneAtTheirOwnNodeAlone) {
  for (const double xi : {-1.0, -0.3, 0.7})
    for (const double eta : {-0.9, 0.2, 1.0}) {
      const Shape shape = shape_at(xi, eta);
      EXPECT_NEAR(shape.value.sum(), 1.0, 1e-14);
      EXPECT_NEAR(shape.gradient.colwise().sum().norm(), 0.0, 1e-14);
    }
  for (int a = 0; a < element_nodes; ++a) {
    const NodeValues value = shape_at(a / 3 - 1.0, a % 3 - 1.0).value;
    EXPECT_NEAR((value - NodeValues::Unit(a)).norm(), 0.0, 1e-15);
  }
}

TEST(Element, ALinearVelocityHasItsStrainRateAtEveryPointOfABentElement) {
  Eigen::Matrix2d gradient;
  gradient << 0.3, -0.7, 1.1, 0.4;
  ElementMatrices e;
  ASSERT_TRUE(e.compute(bent(), Symmetry::plane));
  const Eigen::Matrix<double, strain_rows * element_points, 1> rates =
      e.strain * velocities(bent(), gradient);
  for (int q = 0; q < element_points; ++q) {
    EXPECT_NEAR(rates[4 * q], std::sqrt(2.0) * 0.3, 1e-12);
    EXPECT_NEAR(rates[4 * q + 1], std::sqrt(2.0) * 0.4, 1e-12);
    EXPECT_EQ(rates[4 * q + 2], 0.0);
    EXPECT_NEAR(rates[4 * q + 3], 0.4, 1e-12);
  }
}

TEST(Element, StretchingAlikeInAllDirectionsHasItsRatesAndItsDivergenceAboutAnAxis) {
  ElementMatrices e;
  ASSERT_TRUE(e.compute(bent(), Symmetry::about_axis));
  const auto v = velocities(bent(), Eigen::Matrix2d::Identity());
  const Eigen::Matrix<double, strain_rows * element_points, 1> rates = e.strain * v;
  for (int q = 0; q < element_points; ++q)
    for (int row = 0; row < 3; ++row) EXPECT_NEAR(rates[4 * q + row], std::sqrt(2.0), 1e-12);
  // The first mode is the constant one of unit norm: its moment is div v times the root of the volume.
  const Eigen::Vector3d divergence = e.divergence * v;
  EXPECT_NEAR(divergence[0], 3.0 * std::sqrt(e.weight.sum()), 1e-12);
  EXPECT_NEAR(divergence.tail<2>().norm(), 0.0, 1e-12);
}

TEST(Element, HasTheVolumeOfARing) {
  ElementPositions nodes;
  for (int a = 0; a < element_nodes; ++a) nodes.col(a) = Point(0.1 + 0.1 * (a / 3), 0.05 * (a % 3));
  ElementMatrices e;
  ASSERT_TRUE(e.compute(nodes, Symmetry::about_axis));
  const double volume = 0.5 * (0.09 - 0.01) * 0.1;  // of a radian
  EXPECT_NEAR(e.weight.sum(), volume, 1e-15);
  EXPECT_NEAR(e.volume.sum(), volume, 1e-15);
  EXPECT_NEAR(e.mass.sum(), volume, 1e-15);
}

TEST(Element, SaysThatItIsFolded) {
  ElementPositions nodes = bent();
  nodes.col(8) = nodes.col(4) - Point(0.02, 0.02);
  ElementMatrices e;
  EXPECT_FALSE(e.compute(nodes, Symmetry::plane));
}
