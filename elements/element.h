#pragma once

#include <Eigen/Dense>
#include <array>

#include "elements/problem.h"

/// One element: nine nodes that carry the velocity (Q2), and a pressure linear in space and its own (P1,
/// discontinuous), a pair that satisfies the inf-sup condition (Crouzeix and Raviart 1973; Gresho and Sani
/// 1998, 3.13).
namespace flowrest::elements {

inline constexpr int element_nodes = 9, element_dofs = 18, element_points = 9, element_pressures = 3;
/// Rows of a strain rate: sqrt(2) D_rr, sqrt(2) D_zz, sqrt(2) D_tt, 2 D_rz, so that the shear rate is its
/// norm.
inline constexpr int strain_rows = 4;

using Point = Eigen::Vector2d;  ///< (r, z), or (x, z) in a plane; m
using NodeValues = Eigen::Matrix<double, element_nodes, 1>;
using ElementPositions = Eigen::Matrix<double, 2, element_nodes>;

/// Shape functions and their gradient at a point of the square [-1, 1]^2. Node 3 i + j is the j-th from below
/// in the i-th column.
struct Shape {
  NodeValues value;
  Eigen::Matrix<double, element_nodes, 2> gradient;
};
Shape shape_at(double xi, double eta);

/// Gauss' rule, three by three.
struct GaussPoint {
  double xi, eta, weight;
};
const std::array<GaussPoint, element_points>& gauss_points();

/// The pressure of an element: modes orthonormal over its volume.
struct PressureModes {
  Point centre;
  double size = 0.0;            ///< m
  Eigen::Matrix3d coefficient;  ///< modes = coefficient * (1, (r - centre) / size)
  Eigen::Vector3d at(const Point&) const;
};

/// All that a step needs of an element in one configuration. Volumes are a radian's about the axis, or those
/// of a metre's width in a plane.
struct ElementMatrices {
  Eigen::Matrix<double, strain_rows * element_points, element_dofs>
      strain;                                                         ///< strain rates of unit velocities
  Eigen::Matrix<double, element_points, 1> weight;                    ///< volume of each Gauss point, m3
  Eigen::Matrix<double, element_pressures, element_dofs> divergence;  ///< moments of div v with the modes
  Eigen::Matrix<double, element_nodes, element_nodes> mass;           ///< moments of shape functions, m3
  NodeValues volume;                                                  ///< integrals of shape functions, m3
  PressureModes modes;

  /// @return whether the element is sound: false where it is folded
  bool compute(const ElementPositions&, Symmetry);
};

}  // namespace flowrest::elements
