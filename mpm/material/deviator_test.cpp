#include "mpm/material/deviator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "mpm/test_random.h"

using namespace flowrest::mpm;
using flowrest::mpm::test::Random;

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

Matrix transposed(const Matrix& a) {
  Matrix t{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) t[i][j] = a[j][i];
  return t;
}

Matrix matrix(const Deviator<double, 3>& s) {
  return {{{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz()}}};
}

Matrix matrix(const Deviator<double, 2>& s) {
  return {{{s.xx, s.xy, 0.0}, {s.xy, s.yy, 0.0}, {0.0, 0.0, s.zz()}}};
}

double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// Half of the double contraction, of the matrix as it stands.
double half_square(const Matrix& m) {
  double sum = 0.0;
  for (const auto& row : m)
    for (const double v : row) sum += v * v;
  return 0.5 * sum;
}

double largest_difference(const Matrix& a, const Matrix& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) worst = std::max(worst, std::abs(a[i][j] - b[i][j]));
  return worst;
}

/// Rodrigues' rotation about `axis` (of any length) by `angle`.
Matrix rotation(std::array<double, 3> axis, double angle) {
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  for (auto& c : axis) c /= length;
  const Matrix q = {{{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}}};
  const Matrix qq = product(q, q);
  Matrix r{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      r[i][j] = (i == j ? 1.0 : 0.0) + std::sin(angle) * q[i][j] + (1.0 - std::cos(angle)) * qq[i][j];
  return r;
}

Deviator<double, 3> random_deviator(Random& random) {
  return {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1),
          random.between(-1, 1)};
}

VelocityGradient<double, 3> random_gradient(Random& random, double size) {
  VelocityGradient<double, 3> l;
  for (auto& row : l.g)
    for (double& v : row) v = random.between(-size, size);
  return l;
}

/// L of a rigid rotation with angular velocity omega: L = Omega x.
VelocityGradient<double, 3> spin(const std::array<double, 3>& omega) {
  VelocityGradient<double, 3> l;
  const double g[3][3] = {{0, -omega[2], omega[1]}, {omega[2], 0, -omega[0]}, {-omega[1], omega[0], 0}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) l.g[i][j] = g[i][j];
  return l;
}

VelocityGradient<double, 2> plane_spin(double omega) {
  VelocityGradient<double, 2> l;
  l.g[0][0] = l.g[1][1] = 0.0;
  l.g[0][1] = -omega;
  l.g[1][0] = omega;
  return l;
}

/// What is left of the difference to the start after one full turn in `steps`.
template <class Rotate>
double error_of_a_turn(int steps, Rotate rotate) {
  const std::array<double, 3> omega = {0.3, -0.5, 0.8};
  const double dt = 2.0 * std::numbers::pi / std::hypot(omega[0], omega[1], omega[2]) / steps;
  const Deviator<double, 3> start = {1.0, -0.4, 0.3, 0.2, -0.7};
  Deviator<double, 3> s = start;
  for (int i = 0; i < steps; ++i) s = rotate(s, spin(omega), dt);
  return largest_difference(matrix(s), matrix(start));
}

}  // namespace

TEST(Deviator, HalfSquareIsThatOfTheFullMatrix) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto s = random_deviator(random);
    EXPECT_NEAR(s.half_square(), half_square(matrix(s)), 1e-15);
    const Deviator<double, 2> plane = {s.xx, s.yy, s.xy};
    EXPECT_NEAR(plane.half_square(), half_square(matrix(plane)), 1e-15);
    EXPECT_EQ(matrix(s)[0][0] + matrix(s)[1][1] + matrix(s)[2][2], 0.0);
  }
}

TEST(Deviator, StrainRateIsTheSymmetricTracelessPartOfTheGradient) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto l = random_gradient(random, 5.0);
    const Matrix d = matrix(l.strain_rate_deviator());
    const double third = (l.g[0][0] + l.g[1][1] + l.g[2][2]) / 3.0;
    Matrix expected{};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        expected[a][b] = 0.5 * (l.g[a][b] + l.g[b][a]) - (a == b ? third : 0.0);
    EXPECT_LT(largest_difference(d, expected), 1e-14);
  }
}

TEST(Deviator, HoopStrainTakesItsShareOfTheTrace) {
  VelocityGradient<double, 2> l;
  l.g[0][0] = 2.0;
  l.g[0][1] = 0.5;
  l.g[1][0] = -1.5;
  l.g[1][1] = -1.0;
  l.hoop = 5.0;
  EXPECT_DOUBLE_EQ(l.divergence(), 6.0);
  const auto d = l.strain_rate_deviator();
  EXPECT_DOUBLE_EQ(d.xx, 0.0);
  EXPECT_DOUBLE_EQ(d.yy, -3.0);
  EXPECT_DOUBLE_EQ(d.xy, -0.5);
  EXPECT_DOUBLE_EQ(d.zz(), 3.0);
}

TEST(Rotated, KeepsTheInvariantsAtAnyStep) {
  Random random(3);
  for (int i = 0; i < 10000; ++i) {
    const auto s = random_deviator(random);
    const auto l = random_gradient(random, random.log_between(1e-3, 1e3));
    const double dt = random.log_between(1e-4, 10.0);
    const auto r = rotated(s, l, dt);
    ASSERT_NEAR(r.half_square(), s.half_square(), 1e-14 * s.half_square()) << "dt " << dt;
    ASSERT_NEAR(determinant(matrix(r)), determinant(matrix(s)), 1e-14) << "dt " << dt;
    const Deviator<double, 2> plane = {s.xx, s.yy, s.xy};
    const VelocityGradient<double, 2> in_plane = {{{l.g[0][0], l.g[0][1]}, {l.g[1][0], l.g[1][1]}}, 0.0};
    const auto turned = rotated(plane, in_plane, dt);
    ASSERT_NEAR(turned.half_square(), plane.half_square(), 1e-14 * plane.half_square()) << "dt " << dt;
    ASSERT_NEAR(turned.zz(), plane.zz(), 1e-14) << "the axis normal to the plane does not turn";
  }
}

TEST(Rotated, IsAnExactRotationByTwiceTheArcTangentOfHalfTheStepsAngle) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const auto s = random_deviator(random);
    const std::array<double, 3> omega = {random.between(-9, 9), random.between(-9, 9), random.between(-9, 9)};
    const double dt = random.log_between(1e-4, 1.0);
    const double angle = 2.0 * std::atan(0.5 * dt * std::hypot(omega[0], omega[1], omega[2]));
    const Matrix r = rotation(omega, angle);
    const Matrix expected = product(product(r, matrix(s)), transposed(r));
    ASSERT_LT(largest_difference(matrix(rotated(s, spin(omega), dt)), expected), 1e-14);
  }
}

TEST(Rotated, StretchingAloneTurnsNothing) {
  Random random(5);
  const auto s = random_deviator(random);
  auto l = random_gradient(random, 3.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j) l.g[i][j] = l.g[j][i];
  EXPECT_EQ(largest_difference(matrix(rotated(s, l, 0.7)), matrix(s)), 0.0);
  EXPECT_EQ(largest_difference(matrix(jaumann(s, l, 0.7)), matrix(s)), 0.0);
}

TEST(Rotated, ReturnsTheTensorAfterAFullTurnToSecondOrder) {
  const auto turn = [](const auto& s, const auto& l, double dt) { return rotated(s, l, dt); };
  const double coarse = error_of_a_turn(50, turn), fine = error_of_a_turn(100, turn);
  EXPECT_LT(fine, 5e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.05) << coarse << " and " << fine;
}

TEST(Jaumann, ReturnsTheTensorAfterAFullTurnToFirstOrder) {
  const auto turn = [](const auto& s, const auto& l, double dt) { return jaumann(s, l, dt); };
  const double coarse = error_of_a_turn(2000, turn), fine = error_of_a_turn(4000, turn);
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.05) << coarse << " and " << fine;
}

TEST(Jaumann, IsTheCommutatorWithTheSpin) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const auto s = random_deviator(random);
    const auto l = random_gradient(random, 4.0);
    const double dt = random.log_between(1e-4, 1.0);
    Matrix w{};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) w[a][b] = 0.5 * (l.g[a][b] - l.g[b][a]);
    const Matrix ws = product(w, matrix(s)), sw = product(matrix(s), w);
    Matrix expected = matrix(s);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) expected[a][b] += dt * (ws[a][b] - sw[a][b]);
    ASSERT_LT(largest_difference(matrix(jaumann(s, l, dt)), expected), 1e-14);
  }
}

TEST(Jaumann, AgreesWithTheRotationToFirstOrderInTheStep) {
  Random random(7);
  const auto s = random_deviator(random);
  const auto l = random_gradient(random, 1.0);
  const auto difference = [&](double dt) {
    return largest_difference(matrix(jaumann(s, l, dt)), matrix(rotated(s, l, dt)));
  };
  EXPECT_NEAR(std::log2(difference(2e-3) / difference(1e-3)), 2.0,
              0.02);  // of one step: its error is dt squared
}

TEST(Deviator, TwoDimensionsAreThreeWithNothingAcrossThePlane) {
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Deviator<double, 2> plane = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    const Deviator<double, 3> full = {plane.xx, plane.yy, plane.xy, 0.0, 0.0};
    VelocityGradient<double, 2> l2;
    VelocityGradient<double, 3> l3 = random_gradient(random, 5.0);
    for (int a = 0; a < 3; ++a) l3.g[a][2] = l3.g[2][a] = 0.0;
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) l2.g[a][b] = l3.g[a][b];
    const double dt = random.log_between(1e-4, 1.0);
    EXPECT_LT(largest_difference(matrix(rotated(plane, l2, dt)), matrix(rotated(full, l3, dt))), 1e-14);
    EXPECT_LT(largest_difference(matrix(jaumann(plane, l2, dt)), matrix(jaumann(full, l3, dt))), 1e-14);
    EXPECT_LT(largest_difference(matrix(l2.strain_rate_deviator()), matrix(l3.strain_rate_deviator())),
              1e-14);
    EXPECT_NEAR(plane.half_square(), full.half_square(), 1e-15);
  }
}

TEST(Rotated, TurnsUniaxialTensionWithTheBody) {
  // Tension along x, a quarter of a turn anticlockwise: tension along y.
  const Deviator<double, 2> s = {2.0, -1.0, 0.0};
  const double dt = 2.0 * std::tan(std::numbers::pi / 4.0);
  const auto r = rotated(s, plane_spin(1.0), dt);
  EXPECT_NEAR(r.xx, -1.0, 1e-15);
  EXPECT_NEAR(r.yy, 2.0, 1e-15);
  EXPECT_NEAR(r.xy, 0.0, 1e-15);
  // An eighth: tension along the diagonal, so the shear is positive.
  EXPECT_NEAR(rotated(s, plane_spin(1.0), 2.0 * std::tan(std::numbers::pi / 8.0)).xy, 1.5, 1e-15);
}
