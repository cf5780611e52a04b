#include "elements/element.h"

#include <cmath>
#include <numbers>

namespace flowrest::elements {

namespace {

/// Quadratic Lagrange polynomials on -1, 0, 1, and their slopes.
struct Line {
  double value[3], slope[3];
  explicit Line(double x)
      : value{0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)}, slope{x - 0.5, -2.0 * x, x + 0.5} {}
};

}  // namespace

Shape shape_at(double xi, double eta) {
  const Line across(xi), up(eta);
  Shape shape;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      shape.value[3 * i + j] = across.value[i] * up.value[j];
      shape.gradient(3 * i + j, 0) = across.slope[i] * up.value[j];
      shape.gradient(3 * i + j, 1) = across.value[i] * up.slope[j];
    }
  return shape;
}

const std::array<GaussPoint, element_points>& gauss_points() {
  static const auto points = [] {
    const double place[] = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)};
    const double weight[] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    std::array<GaussPoint, element_points> all{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        all[static_cast<std::size_t>(3 * i + j)] = {place[i], place[j], weight[i] * weight[j]};
    return all;
  }();
  return points;
}

Eigen::Vector3d PressureModes::at(const Point& point) const {
  const Point offset = (point - centre) / size;
  return coefficient * Eigen::Vector3d(1.0, offset.x(), offset.y());
}

bool ElementMatrices::compute(const ElementPositions& position, Symmetry symmetry) {
  static const auto shapes = [] {
    std::array<Shape, element_points> all;
    for (std::size_t q = 0; q < all.size(); ++q)
      all[q] = shape_at(gauss_points()[q].xi, gauss_points()[q].eta);
    return all;
  }();
  strain.setZero();
  mass.setZero();
  volume.setZero();
  modes.centre = position.rowwise().mean();
  modes.size = (position.rowwise().maxCoeff() - position.rowwise().minCoeff()).norm();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  divergence.setZero();
  for (int q = 0; q < element_points; ++q) {
    const Shape& shape = shapes[static_cast<std::size_t>(q)];
    const Eigen::Matrix2d jacobian = position * shape.gradient;
    const double determinant = jacobian.determinant();
    if (!(determinant > 0.0)) return false;
    const Point place = position * shape.value;
    const bool round = symmetry == Symmetry::about_axis;
    const double w =
        gauss_points()[static_cast<std::size_t>(q)].weight * determinant * (round ? place.x() : 1.0);
    if (!(w > 0.0)) return false;
    weight[q] = w;
    const Eigen::Matrix<double, element_nodes, 2> gradient = shape.gradient * jacobian.inverse();
    const Point offset = (place - modes.centre) / modes.size;
    const Eigen::Vector3d plain(1.0, offset.x(), offset.y());
    for (int a = 0; a < element_nodes; ++a) {
      const double by_r = gradient(a, 0), by_z = gradient(a, 1),
                   hoop = round ? shape.value[a] / place.x() : 0.0;
      const int row = strain_rows * q;
      strain(row, 2 * a) = std::numbers::sqrt2 * by_r;
      strain(row + 1, 2 * a + 1) = std::numbers::sqrt2 * by_z;
      strain(row + 2, 2 * a) = std::numbers::sqrt2 * hoop;
      strain(row + 3, 2 * a) = by_z;
      strain(row + 3, 2 * a + 1) = by_r;
      divergence.col(2 * a) += w * (by_r + hoop) * plain;
      divergence.col(2 * a + 1) += w * by_z * plain;
    }
    mass += w * shape.value * shape.value.transpose();
    volume += w * shape.value;
    moments += w * plain * plain.transpose();
  }
  const Eigen::LLT<Eigen::Matrix3d> factor(moments);
  if (factor.info() != Eigen::Success) return false;
  modes.coefficient = factor.matrixL().solve(Eigen::Matrix3d::Identity());
  divergence = (modes.coefficient * divergence).eval();
  return true;
}

}  // namespace flowrest::elements
