#pragma once

#include <array>
#include <cmath>
#include <cstddef>

/// Vectors and tensors over any scalar. Of a section, plane or axisymmetric, the first two axes lie in it;
/// tensors have a third all the same: that across the plane, or the hoop's direction.
namespace flowrest::mpm::plain {

/// A scalar's value alone; numbers that carry derivatives bring their own.
inline double value(double x) { return x; }
inline double value(float x) { return static_cast<double>(x); }

template <class T, int Dim>
using Vec = std::array<T, Dim>;

template <class T>
struct Tensor {
  std::array<std::array<T, 3>, 3> at{};

  std::array<T, 3>& operator[](std::size_t i) { return at[i]; }
  const std::array<T, 3>& operator[](std::size_t i) const { return at[i]; }
  T trace() const { return at[0][0] + at[1][1] + at[2][2]; }
};

template <class T>
Tensor<T> operator*(const Tensor<T>& a, const Tensor<T>& b) {
  Tensor<T> product;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      product[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return product;
}

/// A symmetric tensor without trace.
template <class T>
struct Deviator {
  T xx{}, yy{}, xy{}, xz{}, yz{};

  T zz() const { return -(xx + yy); }
  /// sqrt(s:s / 2)
  T invariant() const {
    using std::sqrt;
    const T square = T(0.5) * (xx * xx + yy * yy + zz() * zz()) + xy * xy + xz * xz + yz * yz;
    return square > T(0) ? sqrt(square) : T(0);
  }
  Tensor<T> tensor() const { return {{{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz()}}}}; }
};

template <class T>
Deviator<T> operator*(const T& factor, const Deviator<T>& s) {
  return {factor * s.xx, factor * s.yy, factor * s.xy, factor * s.xz, factor * s.yz};
}
template <class T>
Deviator<T> operator+(const Deviator<T>& a, const Deviator<T>& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}

/// dev(sym(L))
template <class T>
Deviator<T> strain_rate_deviator(const Tensor<T>& l) {
  const T third = l.trace() / T(3);
  return {l[0][0] - third, l[1][1] - third, T(0.5) * (l[0][1] + l[1][0]), T(0.5) * (l[0][2] + l[2][0]),
          T(0.5) * (l[1][2] + l[2][1])};
}

/// R s R^T with the incremental rotation of Hughes and Winget (1980), R = (I - W dt/2)^-1 (I + W dt/2), W the
/// spin skw(L): the stress turns rigidly, its invariants unchanged.
template <class T>
Deviator<T> rotated(const Deviator<T>& stress, const Tensor<T>& l, const T& dt) {
  // q is the axial vector of W dt/2, Q its cross-product matrix: R = I + 2 (Q + Q Q) / (1 + q.q).
  const T quarter = T(0.25) * dt;
  const T q0 = quarter * (l[2][1] - l[1][2]), q1 = quarter * (l[0][2] - l[2][0]),
          q2 = quarter * (l[1][0] - l[0][1]);
  const T zero(0);
  const Tensor<T> q{{{{zero, -q2, q1}, {q2, zero, -q0}, {-q1, q0, zero}}}};
  const Tensor<T> square = q * q;
  const T scale = T(2) / (T(1) + q0 * q0 + q1 * q1 + q2 * q2);
  Tensor<T> r, transposed;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      r[i][j] = scale * (q[i][j] + square[i][j]);
      if (i == j) r[i][j] += T(1);
      transposed[j][i] = r[i][j];
    }
  const Tensor<T> turned = r * stress.tensor() * transposed;
  return {turned[0][0], turned[1][1], turned[0][1], turned[0][2], turned[1][2]};
}

}  // namespace flowrest::mpm::plain
